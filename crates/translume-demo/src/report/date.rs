//! Today.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// The date in UTC, as 2026-03-01.
pub fn today() -> String {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or(Duration::ZERO);
    let [year, month, day] = civil((since.as_secs() / 86_400) as i64);
    format!("{year}-{month:02}-{day:02}")
}

/// Year, month and day of a day counted from 1970-01-01. Years begin in March, so that the leap day is the last of its year. Source:
/// Hinnant, "chrono-Compatible Low-Level Date Algorithms".
fn civil(day: i64) -> [i64; 3] {
    let day = day + 719_468;
    let (era, of_era) = (day.div_euclid(146_097), day.rem_euclid(146_097));
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let from_march = (5 * of_year + 2) / 153;
    let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
    [400 * era + year + i64::from(month <= 2), month, of_year - (153 * from_march + 2) / 5 + 1]
}

#[cfg(test)]
mod tests {
    use super::civil;

    #[test]
    fn days_have_names() {
        assert_eq!(civil(0), [1970, 1, 1]);
        assert_eq!(civil(59), [1970, 3, 1]);
        assert_eq!([civil(11_016), civil(11_017)], [[2000, 2, 29], [2000, 3, 1]]);
        assert_eq!(civil(20_453), [2025, 12, 31]);
    }
}
