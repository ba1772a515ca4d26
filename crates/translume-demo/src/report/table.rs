//! Rows as CSV and as Markdown.

use super::csv::quoted;
use super::date;
use super::trials::Sweep;
use super::twin::Figures;

/// One measurement.
pub struct Row {
    pub scene: String,
    pub light: String,
    /// How shadows were computed.
    pub shadow: String,
    /// `None` where only the time counts.
    pub figures: Option<Figures>,
    pub time_ms: f64,
    pub sweeps: &'static [Sweep],
}

/// What all rows share.
pub struct Header<'a> {
    pub adapter: &'a str,
    pub atlas: u32,
    pub every: u32,
    pub timed: u32,
}

/// Fields that hold a comma are quoted (RFC 4180); figures of rows that only measure time are empty.
pub fn csv(rows: &[Row], header: &Header<'_>) -> String {
    let mut text = "scene,light,shadow,atlas,rel_rmse,bias,time_ms,adapter\n".to_owned();
    for row in rows {
        let figure =
            |of: fn(&Figures) -> f64| row.figures.as_ref().map_or(String::new(), |f| format!("{:.6}", of(f)));
        let fields = [
            quoted(&row.scene),
            quoted(&row.light),
            quoted(&row.shadow),
            header.atlas.to_string(),
            figure(|f| f.relative_rmse),
            figure(|f| f.bias),
            format!("{:.4}", row.time_ms),
            quoted(header.adapter),
        ];
        text += &fields.join(",");
        text.push('\n');
    }
    text
}

/// A table for each scene, and what its figures mean.
pub fn markdown(rows: &[Row], header: &Header<'_>) -> String {
    let command: Vec<_> = std::env::args().skip(1).collect();
    let mut text = format!(
        "# Irradiance against rays\n\n`translume {}`\n\n{}, {}, atlas {3}².\n\n",
        command.join(" "),
        date::today(),
        header.adapter,
        header.atlas,
    );
    text += &legend(header);
    for (k, row) in rows.iter().enumerate() {
        if k == 0 || rows[k - 1].scene != row.scene {
            text += &format!("\n## {}\n\n{TABLE_HEAD}\n", row.scene);
        }
        text += &line(row);
    }
    text
}

const TABLE_HEAD: &str = "\
| light | shadow | error / mean, % | error / RMS, % | bias, % | ms |
| --- | --- | ---: | ---: | ---: | ---: |";

fn line(row: &Row) -> String {
    let percent = |of: fn(&Figures) -> f64| {
        row.figures.as_ref().map_or("–".to_owned(), |f| format!("{:.2}", 100.0 * of(f)))
    };
    format!(
        "| {} | {} | {} | {} | {} | {:.2} |\n",
        row.light,
        row.shadow,
        percent(|f| f.relative_rmse),
        percent(|f| f.rmse_over_rms),
        percent(|f| f.bias),
        row.time_ms
    )
}

fn legend(header: &Header<'_>) -> String {
    let Header { every, timed, .. } = header;
    format!(
        "\
The truth is irradiance inside the surface (index of refraction {ior}) at one texel in {every}, by rays in double precision: a texel's is the mean
over 4 × 4 points of it in the light of lamps and of a sky with a sun, over 2 × 2 points elsewhere; from each point 16 × 16 rays (8 × 8 for 16 mixed
lights) look at each light that has an extent, there from 2048 texels at most. That of the sky that is not occluded is the sum over all pixels of a map of 512 × 256.

- **error / mean**: RMS of the difference over the mean of the truth, all three channels together, texels in the dark and at the rim included.
- **error / RMS**: the same over the RMS of the truth.
- **bias**: mean of the difference over the mean of the truth; negative is too dark.
- **ms**: what the light costs a frame in which every depth map and all that is known of the sky is made anew: from submission until the device is
  idle, less the same of a frame without light just before; the median of {timed}, of fewer where two seconds
  have gone by. For `no light` it is that frame itself: the gather alone.
- **map, filter, points, directions**: width of a depth map, comparisons along each side of a texel, points of an area light, directions of the sky.
- **flicker**: the first morph target goes from 0.30 to 0.33 in steps of 0.0025. The error is that of the worst frame against the mean of the
  frames before and after it, the curvature of the motion itself included; the bias is the same of the light on the whole body, Σ E·A. The time is the
  median of all frames less that of the same frames in the dark.
- **one …**: without a shadow. **16 mixed**: 4 directional, 4 point and 3 spot lights, 2 rectangles, 2 spheres and a sky, all with shadows.
",
        ior = super::IOR,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_are_quoted_and_missing_figures_empty() {
        let header = Header { adapter: "soft, \"slow\"", atlas: 64, every: 4, timed: 5 };
        let row = Row {
            scene: "egg".to_owned(),
            light: "sun in sky, split".to_owned(),
            shadow: "none".to_owned(),
            figures: None,
            time_ms: 1.5,
            sweeps: &[],
        };
        let text = csv(&[row], &header);
        let line = "egg,\"sun in sky, split\",none,64,,,1.5000,\"soft, \"\"slow\"\"\"";
        assert_eq!(text.lines().nth(1), Some(line));
    }
}
