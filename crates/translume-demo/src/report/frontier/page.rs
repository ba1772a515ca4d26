//! The report as a page for a browser: what was measured, who won, and what it looks like.

use super::dominance::{LEVELS, Level, levels};
use super::entrant::{Family, default_profile};
use super::judge::Against;
use super::row::{Row, Truth};
use super::summary::{Dominant, Summary};
use crate::report::date;
use std::fmt::Write as _;

/// What the page tells of one scene.
pub struct Section {
    pub name: String,
    pub purpose: String,
    pub summary: Summary,
    /// Captions and files of its pictures; the second file is the difference to the truth, where there is one.
    pub pictures: Vec<(String, String, Option<String>)>,
    pub plot: String,
}

pub fn html(sections: &[Section], rows: &[Row], overview: &str, adapter: &str) -> String {
    let mut page = head(adapter);
    page += &summary_table(sections);
    page += "<h2>Speed against error, all scenes</h2>\n<p>Each point is one setting: the geometric mean over the scenes where it ran. A frame \
        is a body that moved: pose, shadows, light, scatter and picture, everything anew. The same as <a href=\"pareto.png\">PNG</a> and <a \
        href=\"pareto.svg\">SVG</a>; every figure is in <a href=\"report.csv\">report.csv</a>.</p>\n<figure class=\"wide\">\n";
    page += overview;
    page += "</figure>\n";
    page += &dominance(sections, rows);
    page += &models(sections, rows);
    for section in sections {
        page += &scene(section, rows);
    }
    page += "</main></body></html>\n";
    page
}

const STYLE: &str = "\
:root { color-scheme: light dark; --line: #8884; --soft: #8882; }
body { font: 16px/1.5 system-ui, sans-serif; margin: 0; }
main { max-width: 1240px; margin: 0 auto; padding: 1.5rem; }
h1 { margin-bottom: .2em } h2 { margin-top: 2.2em; border-bottom: 1px solid var(--line) } p { max-width: 75ch }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 14px }
th, td { padding: .25em .7em; text-align: right; border-bottom: 1px solid var(--soft) }
th:first-child, td:first-child { text-align: left } td.text { text-align: left; max-width: 34ch }
.scroll { overflow-x: auto } .wide svg { max-width: 100%; height: auto; background: #fff } figure { margin: 1em 0 }
.pictures { display: flex; flex-wrap: wrap; gap: 1em } .pictures figure { margin: 0; width: 192px; font-size: 13px }
.pictures img { width: 192px; display: block; background: #000 } .good { color: #08843e } .bad { color: #c33 } .dim { opacity: .65 }
summary { cursor: pointer; margin: .6em 0 }";

fn head(adapter: &str) -> String {
    let command: Vec<_> = std::env::args().skip(1).map(|argument| escaped(&argument)).collect();
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>Translume: speed against error</title>\n<style>{STYLE}</style></head><body><main>\n\
         <h1>Speed against error</h1>\n<p class=\"dim\"><code>translume {}</code> · {} · {} · {} threads</p>\n\
         <p>Every method draws the same pictures of the same bodies. Each picture is held against two truths. The <b>integral</b> \
         is the method's own diffusion profile summed over the surface to convergence, with ray-cast shadows: the distance from it is the \
         <b>quadrature error</b>, what the method loses by being fast. <b>Paths</b> follow light through the volume without any diffusion \
         model: the distance from them is the <b>total error</b>. What lies between the two truths is the <b>model error</b> of the profile; no \
         amount of computing time removes it.</p>\n\
         <p>Errors are the root mean square of the difference over the mean of the truth, all channels together, over the pixels that the \
         body fills; the noise of the paths is taken off. Bias is the mean of the difference over the mean: negative is too dark. ꟻLIP is the mean \
         of what an eye would notice between the pictures as shown, from 0 to 1.</p>\n",
        command.join(" "),
        date::today(),
        escaped(adapter),
        rayon::current_num_threads(),
    )
}

fn summary_table(sections: &[Section]) -> String {
    let mut text = format!(
        "<h2>Scenes</h2>\n<p>The library's default ({}, 512², tolerance 1 %) in each scene. The larger of both errors is the one to work on.</p>\n\
         <div class=\"scroll\"><table>\n<tr><th>scene</th><th></th><th>quadrature error %</th><th>bias %</th><th>model error %</th><th>bias %</th>\
         <th>total %</th><th>ꟻLIP</th><th>noise of the paths %</th><th>dominates</th></tr>\n",
        escaped(default_profile())
    );
    for Section { name, purpose, summary, .. } in sections {
        let dominates = match summary.dominant() {
            Dominant::Model => "model",
            Dominant::Quadrature => "quadrature",
            Dominant::Neither => "neither: within the noise",
            Dominant::Unknown => "unknown",
        };
        let _ = writeln!(
            text,
            "<tr><td><a href=\"#{0}\">{0}</a></td><td class=\"text\">{1}</td>{2}{3}{4}<td>{5}</td><td>{6}</td><td class=\"text\">{dominates}</td></tr>",
            escaped(name),
            escaped(purpose),
            pair(summary.quadrature.as_ref()),
            pair(summary.model.as_ref()),
            cell(summary.total.as_ref().map(|total| total.relative_rmse)),
            summary.flip.map_or("–".to_owned(), |flip| format!("{flip:.3}")),
            percent(summary.noise),
        );
    }
    text += "</table></div>\n";
    for Section { name, summary, .. } in sections {
        if let Some(reason) = &summary.untraced {
            let _ =
                writeln!(text, "<p class=\"dim\">{}: no paths, for {}.</p>", escaped(name), escaped(reason));
        }
    }
    text
}

/// At which error levels something else is cheaper.
fn dominance(sections: &[Section], rows: &[Row]) -> String {
    let mut text = "<h2>Who is cheapest at which error</h2>\n<p>The fastest frame of any method that keeps within a quadrature error: dual tree \
        against all others. A dash: none gets there. Red: another method is faster, and which.</p>\n<div class=\"scroll\"><table>\n<tr><th>scene</th>"
        .to_owned();
    LEVELS.iter().for_each(|level| {
        let _ = write!(text, "<th>{} %</th>", 100.0 * level);
    });
    text += "</tr>\n";
    for Section { name, .. } in sections {
        let _ = write!(text, "<tr><td>{}</td>", escaped(name));
        for level in levels(rows, name, Truth::Converged) {
            text += &duel(&level);
        }
        text += "</tr>\n";
    }
    text + "</table></div>\n"
}

fn duel(level: &Level<'_>) -> String {
    let time = |row: Option<&Row>| row.map_or("–".to_owned(), |row| format!("{:.0}", row.frame_ms));
    let (class, who) = match level.other {
        Some(other) if !level.is_won() => ("bad", format!(", {}", other.family.name())),
        _ => ("good", String::new()),
    };
    format!("<td class=\"{class}\">{} : {} ms{who}</td>", time(level.dual), time(level.other))
}

fn models(sections: &[Section], rows: &[Row]) -> String {
    let mut profiles: Vec<&str> = rows.iter().filter(|row| row.is_model).map(|row| row.profile).collect();
    profiles.sort_unstable();
    profiles.dedup();
    if profiles.is_empty() {
        return String::new();
    }
    let mut text = "<h2>Profiles</h2>\n<p>Total error (bias) in % by profile, at 512² and a tolerance of 1 %: nearly all of it is the model's.</p>\n\
        <div class=\"scroll\"><table>\n<tr><th>scene</th>"
        .to_owned();
    profiles.iter().for_each(|profile| {
        let _ = write!(text, "<th>{}</th>", escaped(profile));
    });
    text += "</tr>\n";
    for Section { name, .. } in sections {
        let _ = write!(text, "<tr><td>{}</td>", escaped(name));
        for profile in &profiles {
            let row = rows.iter().find(|row| row.is_model && row.scene == *name && row.profile == *profile);
            let figures = row.and_then(|row| row.against(Truth::Traced));
            let both = figures.map_or("–".to_owned(), |f| {
                format!("{:.1} ({:+.1})", 100.0 * f.relative_rmse, 100.0 * f.bias)
            });
            let _ = write!(text, "<td>{both}</td>");
        }
        text += "</tr>\n";
    }
    text + "</table></div>\n"
}

fn scene(section: &Section, rows: &[Row]) -> String {
    let mut text = format!(
        "<h2 id=\"{0}\">{0}</h2>\n<p>{1}</p>\n<div class=\"pictures\">\n",
        escaped(&section.name),
        escaped(&section.purpose)
    );
    for (caption, picture, difference) in &section.pictures {
        let _ = write!(text, "<figure><img src=\"{}\" alt=\"{}\">", escaped(picture), escaped(caption));
        if let Some(difference) = difference {
            let _ = write!(text, "<img src=\"{}\" alt=\"ꟻLIP map\">", escaped(difference));
        }
        let _ = writeln!(text, "<figcaption>{}</figcaption></figure>", escaped(caption));
    }
    text += "</div>\n<figure class=\"wide\">\n";
    text += &section.plot;
    text += "</figure>\n<details><summary>All figures</summary><div class=\"scroll\"><table>\n<tr><th>method</th><th>setting</th><th>evaluations per \
        texel</th><th>frame ms</th><th>scatter ms</th><th>quadrature %</th><th>bias %</th><th>total %</th><th>bias %</th><th>99th percentile %</th>\
        <th>PSNR dB</th><th>ꟻLIP</th></tr>\n";
    let own = rows.iter().filter(|row| row.scene == section.name && !row.is_model);
    for family in Family::ALL {
        for row in own.clone().filter(|row| row.family == family) {
            let number = |value: Option<f64>, digits: usize| {
                value.map_or("–".to_owned(), |value| format!("{value:.digits$}"))
            };
            let _ = writeln!(
                text,
                "<tr><td>{}</td><td>{}</td><td>{}</td><td>{:.1}</td><td>{}</td>{}{}{}<td>{}</td><td>{}</td></tr>",
                family.name(),
                escaped(&row.setting),
                number(row.evaluations, 1),
                row.frame_ms,
                number(row.scatter_ms, 1),
                pair(row.against(Truth::Converged)),
                pair(row.against(Truth::Traced)),
                cell(row.against(Truth::Traced).map(|against| against.relative_p99)),
                number(row.verdict.psnr, 1),
                number(row.verdict.flip, 3),
            );
        }
    }
    text + "</table></div></details>\n"
}

fn percent(value: Option<f64>) -> String {
    value.map_or("–".to_owned(), |value| format!("{:.2}", 100.0 * value))
}

fn cell(value: Option<f64>) -> String {
    format!("<td>{}</td>", percent(value))
}

fn pair(against: Option<&Against>) -> String {
    let bias = against.map_or("–".to_owned(), |against| format!("{:+.2}", 100.0 * against.bias));
    format!("{}<td>{bias}</td>", cell(against.map(|against| against.relative_rmse)))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::super::row::example;
    use super::*;

    #[test]
    fn tells_what_was_measured_and_who_lost() {
        let rows = [example(Family::Dual, 10.0, 0.004), example(Family::ScreenSpace, 2.0, 0.15)];
        let section = Section {
            name: "egg, raw".to_owned(),
            purpose: "raw & whole".to_owned(),
            summary: Summary { untraced: Some("a reason".to_owned()), ..Summary::default() },
            pictures: vec![("integral".to_owned(), "egg/integral.png".to_owned(), None)],
            plot: "<svg></svg>".to_owned(),
        };
        let page = html(&[section], &rows, "<svg></svg>", "soft <slow>");
        for word in
            ["egg, raw", "raw &amp; whole", "a reason", "egg/integral.png", "soft &lt;slow&gt;", "0.40"]
        {
            assert!(page.contains(word), "{word}");
        }
        assert!(page.contains("<td class=\"good\">10 : – ms</td>"), "10 ms at .5 %");
        assert!(page.contains("<td class=\"bad\">10 : 2 ms, screen-space diffusion</td>"), "at 20 %");
        let count = |tag: &str| page.matches(tag).count();
        for tag in ["table", "div", "figure", "details", "main", "tr"] {
            assert_eq!(count(&format!("<{tag}")), count(&format!("</{tag}>")), "{tag}");
        }
    }
}
