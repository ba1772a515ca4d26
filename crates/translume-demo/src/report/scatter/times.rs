//! How time grows with the atlas.

use super::Study;
use super::bench::Bench;
use super::row::{Case, Part, Row, Speed};
use crate::error::Error;
use crate::report::bench::Repeats;
use translume::{Medium, Method};

/// Slow enough that once is enough.
const ONCE: Repeats = Repeats { warm_up: 0, timed: 1 };

pub fn measure(study: &Study<'_>, rows: &mut Vec<Row>) -> Result<(), Error> {
    let plan = study.plan;
    let mut times = Vec::new();
    for &size in &plan.time_sizes {
        let scene = plan.timed.open(size)?;
        study.bar.set_message(format!("{} times", scene.name));
        let mut bench = Bench::new(study.gpu, study.translume, &scene)?;
        let medium = plan.media.first().copied().unwrap_or("skimmilk");
        bench.set_medium(Medium::preset(medium)?)?;
        let case = Case { scene: &scene.name, atlas: size, medium, profile: bench.profile() };
        for method in [Method::default(), Method::Tree { theta: 0.4 }, Method::Pattern] {
            let run = bench.run(method, plan.times_repeats)?;
            times.push(Row::new(Part::Times, &case, method, &run));
        }
        if plan.all_pairs_sizes.contains(&size) {
            let run = bench.run(Method::AllPairs, ONCE)?;
            times.push(Row::new(Part::Times, &case, Method::AllPairs, &run));
        } else if plan.sizes.contains(&size) {
            let row = times.last().and_then(|row| extrapolated(&times, row));
            times.extend(row);
        }
        study.bar.inc(1);
    }
    rows.extend(times.iter().map(|row| Row { speed: speed(&times, row), ..row.clone() }));
    Ok(())
}

/// All pairs for the texels of `like`, from the largest atlas that they were measured on: twice the texels take four times as long.
fn extrapolated(rows: &[Row], like: &Row) -> Option<Row> {
    let known = rows.iter().rfind(|row| row.method == Method::AllPairs)?;
    let ratio = like.texels as f64 / known.texels as f64;
    Some(Row {
        atlas: like.atlas,
        texels: like.texels,
        pairs: Some(like.texels as f64),
        time_ms: known.time_ms * ratio * ratio,
        speed: Speed { extrapolated: true, ..Speed::default() },
        ..known.clone()
    })
}

fn speed(rows: &[Row], row: &Row) -> Speed {
    let smaller = rows.iter().rfind(|other| other.method == row.method && other.atlas < row.atlas);
    let growth = smaller.map(|smaller| {
        let texels = row.texels as f64 / smaller.texels as f64;
        (row.time_ms / smaller.time_ms).powf(4.0_f64.ln() / texels.ln())
    });
    let all = rows.iter().find(|other| other.method == Method::AllPairs && other.atlas == row.atlas);
    let gain = all.filter(|_| row.method != Method::AllPairs).map(|all| all.time_ms / row.time_ms);
    Speed { growth, gain, ..row.speed }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(method: Method, atlas: u32, texels: usize, time_ms: f64) -> Row {
        Row { atlas, texels, time_ms, ..Row::example(Part::Times, method) }
    }

    #[test]
    fn growth_is_that_of_four_times_the_texels() {
        let rows = [
            row(Method::Pattern, 64, 1000, 2.0),
            row(Method::AllPairs, 64, 1000, 100.0),
            row(Method::Pattern, 128, 2000, 5.0),
        ];
        let found = speed(&rows, &rows[2]);
        // Twice the texels took 2.5 times as long.
        assert!((found.growth.unwrap() - 6.25).abs() < 1e-12 && found.gain.is_none());
        assert_eq!(speed(&rows, &rows[0]), Speed { gain: Some(50.0), ..Speed::default() });
        let more = extrapolated(&rows, &rows[2]).unwrap();
        assert_eq!((more.time_ms, more.atlas, more.speed.extrapolated), (400.0, 128, true));
    }
}
