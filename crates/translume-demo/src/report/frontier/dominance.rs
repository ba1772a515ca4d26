//! Whether the dual tree is the cheapest at every error.

use super::entrant::Family;
use super::row::{Row, Truth};

/// Errors at which times are compared.
pub const LEVELS: [f64; 6] = [0.005, 0.01, 0.02, 0.05, 0.1, 0.2];

/// The cheapest ways to keep within one of [`LEVELS`].
pub struct Level<'a> {
    pub dual: Option<&'a Row>,
    pub other: Option<&'a Row>,
}

impl Level<'_> {
    /// Whether nothing else is cheaper; where nobody keeps within the error there is nothing to win.
    pub fn is_won(&self) -> bool {
        match (self.dual, self.other) {
            (Some(dual), Some(other)) => dual.frame_ms <= other.frame_ms,
            (None, Some(_)) => false,
            (_, None) => true,
        }
    }
}

/// One scene, level by level.
pub fn levels<'a>(rows: &'a [Row], scene: &str, truth: Truth) -> Vec<Level<'a>> {
    let of = |level: f64, which: fn(Family) -> bool| {
        rows.iter()
            .filter(|row| row.scene == scene && !row.is_model && which(row.family))
            .filter(|row| row.against(truth).is_some_and(|against| against.relative_rmse <= level))
            .min_by(|a, b| a.frame_ms.total_cmp(&b.frame_ms))
    };
    LEVELS
        .into_iter()
        .map(|level| Level { dual: of(level, Family::is_dual), other: of(level, |family| !family.is_dual()) })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::row::example;
    use super::*;

    #[test]
    fn the_cheapest_within_the_error_counts() {
        let rows = [
            example(Family::Dual, 10.0, 0.009),
            example(Family::Dual, 5.0, 0.04),
            example(Family::PerVertex, 4.0, 0.3),
            example(Family::ScreenSpace, 3.0, 0.15),
            example(Family::AllPairs, 900.0, 0.001),
        ];
        let won: Vec<bool> = levels(&rows, "egg, raw", Truth::Converged).iter().map(Level::is_won).collect();
        // .5 %: all pairs alone; 1 to 5 %: the dual tree; from 10 % on (the level .2) the picture's own space.
        assert_eq!(won, [false, true, true, true, true, false]);
        assert!(levels(&rows, "another", Truth::Converged).iter().all(Level::is_won));
        assert!(levels(&rows, "egg, raw", Truth::Traced).iter().all(|level| level.dual.is_none()));
    }
}
