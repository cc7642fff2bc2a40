//! What paper 001 says of the methods (its Figure 7 and section 5), and what the numbers of this
//! comparison say.

use super::{Comparison, Summary};
use serde::Serialize;

/// A claim of the paper beside the numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Claim {
    /// What the paper says.
    pub paper: String,
    /// What was counted and measured.
    pub numbers: String,
    /// Whether they agree.
    pub verdict: Verdict,
}

/// Whether the numbers agree with the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// They say the same.
    Agrees,
    /// Some do and some do not.
    Partly,
    /// They say the opposite.
    Disagrees,
}

impl Verdict {
    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::Partly => "partly",
            Self::Disagrees => "disagrees",
        }
    }

    fn of(yes: usize, all: usize) -> Self {
        match yes {
            _ if yes == all => Self::Agrees,
            0 => Self::Disagrees,
            _ => Self::Partly,
        }
    }
}

/// Volume kept below this counts as vanishing.
const VANISHED: f64 = 0.5;

/// The claims about methods that are present; `about` has its summaries.
pub fn claims(about: &Comparison) -> Vec<Claim> {
    let of = |name: &str| about.methods.iter().find(|m| m.method == name && m.frames > 0);
    let parents = about.parents.iter().map(|p| p.pieces).max().unwrap_or(1);
    let mut all = Vec::new();
    all.extend(of("linear").map(|m| linear(m, parents)));
    all.extend(of("space-time").map(|m| space_time(m, parents, about)));
    if let (Some(linear), Some(m)) = (of("linear"), of("feature-volume")) {
        all.push(better(
            "Feature-based volume metamorphosis produces better results.",
            m,
            &[linear],
        ));
    }
    let automatic: Vec<&Summary> = ["linear", "space-time"].into_iter().filter_map(of).collect();
    if let Some(m) = of("graft:paper").or(of("graft:fields-space-time"))
        && !automatic.is_empty()
    {
        let said = "User control allows to obtain far better results than automatic \
                    metamorphosis: feature by feature, with space-time blending and local offsets.";
        all.push(better(said, m, &automatic));
        all.push(one_piece("Small and thin features are kept from vanishing.", m));
    }
    if let Some(m) = of("graft") {
        let said = "(Ours, for what the paper aims at.) The graft of positions stays in one piece.";
        all.push(one_piece(said, m));
    }
    all
}

fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "unknown".to_owned(), |v| format!("{v:.decimals$}"))
}

fn pieces(m: &Summary) -> String {
    let most = m.pieces_max.map_or_else(|| "no".to_owned(), |n| n.to_string());
    let Summary { whole, nearly_whole, frames, .. } = m;
    let specks = match nearly_whole > whole {
        true => format!(" ({nearly_whole} when specks under 0.5% of the volume do not count)"),
        false => String::new(),
    };
    format!("{most} pieces at most, in one piece at {whole} of {frames} times{specks}")
}

fn missing(m: &Summary) -> String {
    match m.frames - m.made {
        0 => String::new(),
        1 => ", nothing left at 1 time".to_owned(),
        n => format!(", nothing left at {n} times"),
    }
}

fn linear(m: &Summary, parents: u64) -> Claim {
    let broken = m.pieces_max.is_some_and(|n| n > parents) || m.made < m.frames;
    let gone = m.made < m.frames || m.kept_min.is_some_and(|k| k < VANISHED);
    let kept = number(m.kept_min, 2);
    Claim {
        paper: "With thin feature elements, linear metamorphosis does not produce sensible \
                results."
            .to_owned(),
        numbers: format!("{}; least volume kept {kept}{}.", pieces(m), missing(m)),
        verdict: Verdict::of(usize::from(broken) + usize::from(gone), 2),
    }
}

fn space_time(m: &Summary, parents: u64, about: &Comparison) -> Claim {
    let extra = m.extra_handles.unwrap_or(0);
    let broken = m.pieces_max.is_some_and(|n| n > parents) || m.made < m.frames;
    let height = about.shapes.iter().map(|s| s.bbox_mm[1][2] - s.bbox_mm[0][2]).fold(0.0, f64::max);
    let stray = m.stray_mm.unwrap_or(0.0);
    // farther from both parents than a leg is wide
    let grown = extra > 0 || stray > 0.05 * height;
    Claim {
        paper: "Space-time blending leads to some features disappearing and growing in unwanted \
                places."
            .to_owned(),
        numbers: format!(
            "{}; {extra} handles more than either parent has; surface up to {stray:.0} mm from the \
             nearer parent; least volume kept {} (its height is chosen so that the volume is \
             kept){}. Disappearing is counted as breaking up, growing as handles or as straying by \
             more than 5% of the height.",
            pieces(m),
            number(m.kept_min, 2),
            missing(m)
        ),
        verdict: Verdict::of(usize::from(broken) + usize::from(grown), 2),
    }
}

/// Whether `m` does better than each of `others` in pieces, volume and evenness of motion.
fn better(said: &str, m: &Summary, others: &[&Summary]) -> Claim {
    let (mut won, mut contests) = (0, 0);
    let mut parts = Vec::new();
    for other in others {
        let counts = [
            (other.frames - other.whole, m.frames - m.whole),
            (other.frames - other.nearly_whole, m.frames - m.nearly_whole),
            (other.frames - other.made, m.frames - m.made),
        ];
        let lengths = [(other.kept_off, m.kept_off), (other.unevenness, m.unevenness)];
        let mut tally = |less: bool, more: bool| {
            contests += usize::from(less || more);
            won += usize::from(less);
        };
        counts.iter().for_each(|(theirs, ours)| tally(ours < theirs, ours > theirs));
        for (theirs, ours) in lengths {
            if let (Some(theirs), Some(ours)) = (theirs, ours) {
                tally(ours < theirs, ours > theirs);
            }
        }
        parts.push(format!(
            "{}: in one piece at {} of {} ({} but for specks), volume off by {}%, unevenness {}",
            other.method,
            other.whole,
            other.frames,
            other.nearly_whole,
            number(other.kept_off.map(|k| k * 100.0), 0),
            number(other.unevenness, 2)
        ));
    }
    let numbers = format!(
        "{}: in one piece at {} of {} times ({} but for specks){}, volume off by {}%, unevenness {}; {}. \
         Better in {won} of {contests} counts that differ.",
        m.method,
        m.whole,
        m.frames,
        m.nearly_whole,
        missing(m),
        number(m.kept_off.map(|k| k * 100.0), 0),
        number(m.unevenness, 2),
        parts.join("; ")
    );
    Claim { paper: said.to_owned(), numbers, verdict: Verdict::of(won, contests.max(1)) }
}

fn one_piece(said: &str, m: &Summary) -> Claim {
    let numbers = format!(
        "{}: {}; least volume kept {}, thinnest wall {} mm{}.",
        m.method,
        pieces(m),
        number(m.kept_min, 2),
        number(m.min_wall_mm, 1),
        missing(m)
    );
    let verdict = match m.frames - m.whole {
        0 => Verdict::Agrees,
        broken if broken * 3 <= m.frames || m.nearly_whole == m.frames => Verdict::Partly,
        _ => Verdict::Disagrees,
    };
    Claim { paper: said.to_owned(), numbers, verdict }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summary(method: &str, whole: usize, kept: f64) -> Summary {
        Summary {
            method: method.to_owned(),
            frames: 9,
            made: 9,
            whole,
            nearly_whole: whole,
            pieces_max: Some(if whole == 9 { 1 } else { 40 }),
            kept_min: Some(kept),
            kept_off: Some(1.0 - kept),
            unevenness: Some(1.2),
            ..Summary::default()
        }
    }

    fn verdicts(methods: Vec<Summary>) -> Vec<Verdict> {
        let about = Comparison { methods, ..Comparison::default() };
        claims(&about).iter().map(|c| c.verdict).collect()
    }

    #[test]
    fn the_numbers_decide() {
        let (bad, good) = (summary("linear", 2, 0.1), summary("linear", 9, 0.95));
        assert_eq!(verdicts(vec![bad.clone()]), [Verdict::Agrees]);
        assert_eq!(verdicts(vec![good.clone()]), [Verdict::Disagrees]);
        assert_eq!(verdicts(vec![summary("linear", 2, 0.95)]), [Verdict::Partly]);
        let lerios = summary("feature-volume", 9, 0.9);
        assert_eq!(verdicts(vec![bad, lerios.clone()])[1], Verdict::Agrees);
        assert_eq!(verdicts(vec![good, lerios])[1], Verdict::Disagrees);
        assert_eq!(verdicts(vec![summary("graft", 9, 1.0)]), [Verdict::Agrees]);
        assert_eq!(verdicts(vec![summary("graft", 8, 1.0)]), [Verdict::Partly]);
        assert_eq!(verdicts(vec![summary("graft", 0, 1.0)]), [Verdict::Disagrees]);
        let specks = Summary { nearly_whole: 9, ..summary("graft", 0, 1.0) };
        assert_eq!(verdicts(vec![specks]), [Verdict::Partly]);
        assert!(verdicts(vec![summary("group", 9, 1.0)]).is_empty());
        assert!(verdicts(vec![Summary::refused("graft", "no features")]).is_empty());
    }
}
