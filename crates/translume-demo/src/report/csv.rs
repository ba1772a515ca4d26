//! Fields of a CSV file.

/// Quoted where it holds a comma, a quote or the end of a line (RFC 4180).
pub fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n']) {
        return format!("\"{}\"", field.replace('"', "\"\""));
    }
    field.to_owned()
}
