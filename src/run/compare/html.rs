//! `report.html`: one file that opens without a network and asks nobody for anything.

use super::summary::MEASURES;
use super::{COLUMNS, Comparison, Row, Summary, claims::Verdict};
use crate::picture::Image;
use crate::run::time_word;
use std::fmt::Write;

const PAGE: &str = include_str!("report.html");
const STYLE: &str = include_str!("report.css");
const SCRIPT: &str = include_str!("report.js");

/// The page. Pictures lie in the order of the rows.
pub(super) fn page(about: &Comparison, pictures: &[Option<Image>]) -> String {
    let parts = [
        ("{{style}}", STYLE.to_owned()),
        ("{{title}}", escaped(title(about))),
        ("{{lead}}", lead(about)),
        ("{{table}}", table(about)),
        ("{{failed}}", failed(about)),
        ("{{grid}}", grid(about, pictures)),
        ("{{claims}}", claims(about)),
        ("{{frames}}", frames(about)),
        ("{{definitions}}", definitions(about)),
        ("{{facts}}", facts(about)),
        ("{{data}}", data(about)),
        ("{{script}}", SCRIPT.to_owned()),
    ];
    fill(PAGE, &parts)
}

/// The template with every placeholder filled once; what is filled in is not looked at again.
fn fill(template: &str, parts: &[(&str, String)]) -> String {
    let mut page = String::new();
    let mut rest = template;
    while let Some(at) = rest.find("{{") {
        page += &rest[..at];
        rest = &rest[at..];
        match parts.iter().find(|(key, _)| rest.starts_with(key)) {
            Some((key, text)) => {
                page += text;
                rest = &rest[key.len()..];
            }
            None => {
                page += "{{";
                rest = &rest[2..];
            }
        }
    }
    page + rest
}

/// Text as it may stand between tags and in quoted attributes.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\'' => out += "&#39;",
            c => out.push(c),
        }
    }
    out
}

fn title(about: &Comparison) -> &str {
    if about.name.is_empty() { "methods compared" } else { &about.name }
}

/// One sentence on what was compared.
fn lead(about: &Comparison) -> String {
    let parents: Vec<String> =
        about.parents.iter().map(|p| format!("<b>{}</b>", escaped(&p.name))).collect();
    let made = about.methods.iter().filter(|m| m.frames > 0).count();
    let methods = if made == 1 { "1 method".to_owned() } else { format!("{made} methods") };
    let times = match about.times.len() {
        1 => "one time".to_owned(),
        n => format!("{n} times"),
    };
    let [x, y, z] = about.samples;
    format!(
        "{methods} from {} at {times}, on one lattice of {x} × {y} × {z} samples with cells of {:.2} mm, \
         through one mesher, with the same measures.",
        parents.join(" to "),
        about.voxel_mm
    )
}

/// The table of methods.
fn table(about: &Comparison) -> String {
    let mut head = String::from("<th scope=\"col\">method</th>");
    for m in MEASURES {
        let unit =
            if m.unit.is_empty() { String::new() } else { format!("<small>{}</small>", m.unit) };
        let _ =
            write!(head, "<th scope=\"col\" title=\"{}\">{} {unit}</th>", escaped(m.says), m.title);
    }
    let shown: Vec<Summary> = about.methods.iter().filter(|m| m.frames > 0).cloned().collect();
    let winners: Vec<Vec<bool>> = MEASURES.iter().map(|m| m.winners(&shown)).collect();
    let mut body = String::new();
    for (i, s) in shown.iter().enumerate() {
        let _ = write!(
            body,
            "<tr data-method=\"{0}\"><th scope=\"row\"><i class=\"key\"></i>{0}</th>",
            escaped(&s.method)
        );
        for (m, winners) in MEASURES.iter().zip(&winners) {
            let text = m.text(s).unwrap_or_else(|| "–".to_owned());
            if winners[i] {
                let _ =
                    write!(body, "<td class=\"best\">{text}<span class=\"vh\"> (best)</span></td>");
            } else {
                let _ = write!(body, "<td>{text}</td>");
            }
        }
        body += "</tr>";
    }
    format!("<thead><tr>{head}</tr></thead><tbody>{body}</tbody>")
}

/// Methods that do not apply, and frames that have no mesh.
fn failed(about: &Comparison) -> String {
    let mut rows = String::new();
    let mut put = |method: &str, t: &str, why: &str| {
        let _ = write!(
            rows,
            "<tr><th scope=\"row\">{}</th><td>{t}</td><td>{}</td></tr>",
            escaped(method),
            escaped(why)
        );
    };
    for s in about.methods.iter().filter(|s| s.frames == 0) {
        put(&s.method, "all", s.error.as_deref().unwrap_or("not made"));
    }
    let applies = |r: &&Row| about.methods.iter().any(|s| s.method == r.method && s.frames > 0);
    for r in about.rows.iter().filter(applies) {
        if let Some(why) = &r.error {
            put(&r.method, &time_word(r.t), why);
        }
    }
    if rows.is_empty() {
        return "<p>None: every method has a mesh at every time.</p>".to_owned();
    }
    format!(
        "<div class=\"wide\"><table class=\"words\"><thead><tr><th scope=\"col\">method</th><th scope=\"col\">t</th>\
         <th scope=\"col\">why there is no mesh</th></tr></thead><tbody>{rows}</tbody></table></div>"
    )
}

/// Rows are methods, columns are times.
fn grid(about: &Comparison, pictures: &[Option<Image>]) -> String {
    let mut text = String::from("<thead><tr><td></td>");
    for t in &about.times {
        let _ = write!(text, "<th scope=\"col\">t = {}</th>", time_word(*t));
    }
    text += "</tr></thead><tbody>";
    for s in about.methods.iter().filter(|s| s.frames > 0) {
        let name = escaped(&s.method);
        let _ = write!(text, "<tr data-method=\"{name}\"><th scope=\"row\">{name}</th>");
        for (k, &t) in about.times.iter().enumerate() {
            let at = about.rows.iter().position(|r| r.method == s.method && r.t == t);
            let picture = at.and_then(|i| pictures.get(i)?.as_ref()).and_then(source);
            let _ = match picture {
                Some(src) => write!(
                    text,
                    "<td><img alt=\"{name} at t = {}\" data-k=\"{k}\" src=\"{src}\"></td>",
                    time_word(t)
                ),
                None => write!(text, "<td class=\"none\">no mesh</td>"),
            };
        }
        text += "</tr>";
    }
    text + "</tbody>"
}

/// A picture as an address that holds it.
fn source(image: &Image) -> Option<String> {
    Some(format!("data:image/png;base64,{}", base64(&image.to_png().ok()?)))
}

/// RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let at = |i: usize| u32::from(group.get(i).copied().unwrap_or(0));
        let bits = at(0) << 16 | at(1) << 8 | at(2);
        for i in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * i) & 63) as usize];
            text.push(if i <= group.len() { letter as char } else { '=' });
        }
    }
    text
}

fn claims(about: &Comparison) -> String {
    if about.claims.is_empty() {
        return "<p>None of the methods of the paper's Figure 7 is in this comparison.</p>"
            .to_owned();
    }
    let mut rows = String::new();
    for c in &about.claims {
        let class = match c.verdict {
            Verdict::Agrees => "yes",
            Verdict::Partly => "half",
            Verdict::Disagrees => "no",
        };
        let _ = write!(
            rows,
            "<tr><td>{}</td><td>{}</td><td><span class=\"verdict {class}\">{}</span></td></tr>",
            escaped(&c.paper),
            escaped(&c.numbers),
            c.verdict.word()
        );
    }
    format!(
        "<div class=\"wide\"><table class=\"words\"><thead><tr><th scope=\"col\">the paper says</th>\
         <th scope=\"col\">the numbers of this run</th><th scope=\"col\">verdict</th></tr></thead>\
         <tbody>{rows}</tbody></table></div>"
    )
}

/// A column of the table of frames: its name in `metrics.csv`, and decimals.
const SHOWN: [(&str, usize); 17] = [
    ("method", 0),
    ("t", 3),
    ("seconds", 2),
    ("peak_mb", 0),
    ("triangles", 0),
    ("pieces", 0),
    ("components", 0),
    ("genus", 0),
    ("volume_kept", 2),
    ("area_mm2", 0),
    ("min_wall_mm", 2),
    ("hausdorff_to_a_mm", 1),
    ("hausdorff_to_b_mm", 1),
    ("step_mm", 1),
    ("mean_step_mm", 2),
    ("stray_mm", 1),
    ("gradient_error", 3),
];

fn frames(about: &Comparison) -> String {
    let columns =
        SHOWN.iter().filter_map(|(n, d)| Some((COLUMNS.iter().find(|c| c.name == *n)?, *d)));
    let columns: Vec<_> = columns.collect();
    let mut text = String::from("<thead><tr>");
    for (c, _) in &columns {
        let _ = write!(text, "<th scope=\"col\">{}</th>", c.name);
    }
    text += "</tr></thead><tbody>";
    let cell = |row: &Row, (c, decimals): &(&super::Column, usize)| {
        let raw = (c.text)(row);
        match raw.parse::<f64>() {
            Ok(v) if c.name != "t" => format!("{v:.decimals$}"),
            _ if raw.is_empty() => "–".to_owned(),
            _ => escaped(&raw),
        }
    };
    for row in &about.rows {
        text += "<tr>";
        for (i, column) in columns.iter().enumerate() {
            let text_ = cell(row, column);
            let _ = match i {
                0 => write!(text, "<th scope=\"row\">{text_}</th>"),
                _ => write!(text, "<td>{text_}</td>"),
            };
        }
        text += "</tr>";
    }
    text + "</tbody>"
}

/// What each method and each measure is.
fn definitions(about: &Comparison) -> String {
    let mut text = String::from("<h3>Methods</h3><dl>");
    for [name, says] in &about.says {
        let _ = write!(text, "<dt>{}</dt><dd>{}</dd>", escaped(name), escaped(says));
    }
    text += "</dl><h3>Table of methods</h3><dl>";
    for m in MEASURES {
        let _ = write!(text, "<dt>{}</dt><dd>{}</dd>", m.title, escaped(m.says));
    }
    text += "</dl><h3>Columns of metrics.csv</h3><dl>";
    for c in COLUMNS {
        let unit =
            if c.unit.is_empty() { String::new() } else { format!(" <small>{}</small>", c.unit) };
        let _ = write!(text, "<dt><code>{}</code>{unit}</dt><dd>{}</dd>", c.name, escaped(c.says));
    }
    text + "</dl>"
}

/// Recipe, program and machine.
fn facts(about: &Comparison) -> String {
    let number = |v: Option<f64>| v.map_or_else(|| "–".to_owned(), |v| format!("{v:.0}"));
    let m = &about.machine;
    let processor = m.processor.as_deref().map_or(String::new(), |p| format!(", {p}"));
    let mut all = vec![
        ("recipe", about.recipe.clone().unwrap_or_default()),
        ("its SHA-256", about.recipe_sha256.clone()),
        ("program", format!("fieldgraft {}", about.version)),
        ("command", about.arguments.join(" ")),
        (
            "machine",
            format!("{} {}, {} cores, {} threads{processor}", m.os, m.arch, m.cores, m.threads),
        ),
        (
            "time",
            format!(
                "{:.1} s in all, {:.1} s of it to read the shapes and make their fields (once for all methods)",
                about.seconds_total, about.seconds_shapes
            ),
        ),
        ("peak memory", format!("{} MB", number(about.peak_memory_mb))),
    ];
    for p in &about.parents {
        let wall = p.min_wall_mm.map_or_else(|| "–".to_owned(), |w| format!("{w:.2}"));
        let genus = p.genus.map_or_else(|| "–".to_owned(), |g| g.to_string());
        let volume = number(p.volume_mm3.map(|v| v / 1e3));
        let (pieces, area) = (p.pieces, p.area_mm2 / 100.0);
        let text = format!(
            "{}: {pieces} piece(s), genus {genus}, {volume} cm³, {area:.0} cm², thinnest wall {wall} mm",
            p.name
        );
        all.push(("parent", text));
    }
    for a in &about.animations {
        let why = a.error.as_ref().or(a.note.as_ref());
        all.extend(a.file.as_ref().or(why).map(|text| ("animation", text.clone())));
    }
    for s in &about.searches {
        all.push(("search", format!("{}: {} combinations tried", s.hybrid, s.tried)));
    }
    all.extend(about.notes.iter().map(|n| ("note", n.clone())));
    all.extend(about.inputs.iter().map(|i| ("input", format!("{}, SHA-256 {}", i.file, i.sha256))));
    let mut text = String::from("<dl class=\"facts\">");
    for (name, value) in all {
        let _ = write!(text, "<dt>{name}</dt><dd>{}</dd>", escaped(&value));
    }
    text + "</dl>"
}

/// What the script draws, as JSON that cannot end its own element.
fn data(about: &Comparison) -> String {
    let methods: Vec<&str> =
        about.methods.iter().filter(|m| m.frames > 0).map(|m| m.method.as_str()).collect();
    let value = serde_json::json!({ "methods": methods, "times": about.times, "rows": about.rows });
    value.to_string().replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_the_rfc() {
        for (plain, coded) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn names_are_text_everywhere() {
        let evil = "</script><script>alert('\"&{{data}}')</script>";
        let about = Comparison {
            name: evil.to_owned(),
            recipe: Some(evil.to_owned()),
            says: vec![[evil.to_owned(), evil.to_owned()]],
            methods: vec![
                Summary { method: evil.to_owned(), frames: 1, ..Summary::default() },
                Summary::refused(evil, evil),
            ],
            rows: vec![Row {
                method: evil.to_owned(),
                error: Some(evil.to_owned()),
                ..Row::default()
            }],
            times: vec![0.0],
            ..Comparison::default()
        };
        let page = page(&about, &[None]);
        // the page's own two scripts and no other
        assert_eq!(page.matches("<script").count(), 2);
        assert_eq!(page.matches("</script").count(), 2);
        assert!(!page.contains("<script>alert"));
        assert!(!page.contains("{{style}}") && !page.contains("{{script}}"));
        for request in ["http://", "https://", "url(", "@import", "fetch("] {
            let own = page.replace("http://www.w3.org/2000/svg", "");
            assert!(!own.contains(request), "{request}");
        }
    }
}
