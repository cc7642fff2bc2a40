//! One method over all times.

use super::row::{Best, Row};
use serde::Serialize;

/// What a method did over all times.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// The method's name.
    pub method: String,
    /// Times asked for.
    pub frames: usize,
    /// Times at which there is a mesh.
    pub made: usize,
    /// Why the method does not apply, or the first reason why a frame has no mesh.
    pub error: Option<String>,
    /// Times at which the result is of one piece.
    pub whole: usize,
    /// Times at which all but one of the pieces are specks.
    pub nearly_whole: usize,
    /// Most pieces at a time.
    pub pieces_max: Option<u64>,
    /// Least volume kept.
    pub kept_min: Option<f64>,
    /// Mean of |volume kept - 1|.
    pub kept_off: Option<f64>,
    /// Handles above those of the parent with more, the most at a time; no less than 0.
    pub extra_handles: Option<i64>,
    /// Thinnest wall at any time, mm.
    pub min_wall_mm: Option<f64>,
    /// Largest step, mm.
    pub step_max_mm: Option<f64>,
    /// Largest over mean speed; speed is step over the difference in t, and 1 is even motion.
    pub unevenness: Option<f64>,
    /// Largest distance to the nearer parent at any time, mm.
    pub stray_mm: Option<f64>,
    /// Mean error of the gradient over all times.
    pub gradient_error: Option<f64>,
    /// Seconds of all frames.
    pub seconds: Option<f64>,
    /// Largest peak memory, MB.
    pub peak_mb: Option<f64>,
}

fn known<'a>(
    rows: &'a [Row],
    of: impl Fn(&Row) -> Option<f64> + 'a,
) -> impl Iterator<Item = f64> + 'a {
    rows.iter().filter_map(of)
}

fn most(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.reduce(f64::max)
}

fn least(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.reduce(f64::min)
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, n) = values.fold((0.0, 0), |(sum, n), v| (sum + v, n + 1));
    (n > 0).then(|| sum / f64::from(n))
}

impl Summary {
    /// Sums up the rows of one method, in the order of t; `handles` is the genus of the parent that
    /// has more.
    pub fn of(method: &str, rows: &[Row], handles: i64) -> Self {
        let steps = rows.windows(2).filter_map(|w| Some(w[1].step_mm? / (w[1].t - w[0].t)));
        let speeds: Vec<f64> = steps.filter(|s| s.is_finite()).collect();
        let mean_speed = mean(speeds.iter().copied()).filter(|m| *m > 0.0);
        let extra = rows.iter().filter_map(|r| r.genus).max().map(|g| (g - handles).max(0));
        Self {
            method: method.to_owned(),
            frames: rows.len(),
            made: rows.iter().filter(|r| r.error.is_none()).count(),
            error: rows.iter().find_map(|r| r.error.clone()),
            whole: rows.iter().filter(|r| r.pieces == Some(1)).count(),
            nearly_whole: rows.iter().filter(|r| r.large_pieces == Some(1)).count(),
            pieces_max: rows.iter().filter_map(|r| r.pieces).max(),
            kept_min: least(known(rows, |r| r.volume_kept)),
            kept_off: mean(known(rows, |r| r.volume_kept.map(|k| (k - 1.0).abs()))),
            extra_handles: extra,
            min_wall_mm: least(known(rows, |r| r.min_wall_mm)),
            step_max_mm: most(known(rows, |r| r.step_mm)),
            unevenness: most(speeds.iter().copied()).zip(mean_speed).map(|(most, m)| most / m),
            stray_mm: most(known(rows, |r| r.stray_mm)),
            gradient_error: mean(known(rows, |r| r.gradient_error)),
            seconds: known(rows, |r| r.seconds).reduce(|a, b| a + b),
            peak_mb: most(known(rows, |r| r.peak_mb)),
        }
    }

    /// A method that does not apply.
    pub fn refused(method: &str, why: &str) -> Self {
        Self { method: method.to_owned(), error: Some(why.to_owned()), ..Self::default() }
    }

    /// Whether there is a mesh at every time: only such methods are ranked.
    pub fn complete(&self) -> bool {
        self.frames > 0 && self.made == self.frames
    }
}

/// A column of the table of methods.
pub struct Measure {
    /// What stands above it.
    pub title: &'static str,
    /// Its unit; empty for a plain number.
    pub unit: &'static str,
    /// What it is.
    pub says: &'static str,
    /// What is good.
    pub best: Best,
    /// Decimals shown.
    pub decimals: usize,
    /// The value.
    pub value: fn(&Summary) -> Option<f64>,
}

/// The columns of the table of methods.
pub const MEASURES: &[Measure] = &[
    Measure {
        title: "frames",
        unit: "",
        says: "times at which there is a mesh",
        best: Best::High,
        decimals: 0,
        value: |s| Some(s.made as f64),
    },
    Measure {
        title: "in one piece",
        unit: "",
        says: "times at which the result is of one piece",
        best: Best::High,
        decimals: 0,
        value: |s| (s.made > 0).then_some(s.whole as f64),
    },
    Measure {
        title: "one piece but for specks",
        unit: "",
        says: "times at which all but one of the pieces have under 0.5% of the volume each",
        best: Best::High,
        decimals: 0,
        value: |s| (s.made > 0).then_some(s.nearly_whole as f64),
    },
    Measure {
        title: "most pieces",
        unit: "",
        says: "most solids at a time",
        best: Best::Low,
        decimals: 0,
        value: |s| s.pieces_max.map(|n| n as f64),
    },
    Measure {
        title: "extra handles",
        unit: "",
        says: "genus above that of the parent with more, the most at a time",
        best: Best::Low,
        decimals: 0,
        value: |s| s.extra_handles.map(|n| n as f64),
    },
    Measure {
        title: "least volume kept",
        unit: "",
        says: "volume over the weighted mean of the parents'",
        best: Best::High,
        decimals: 2,
        value: |s| s.kept_min,
    },
    Measure {
        title: "mean volume off",
        unit: "%",
        says: "mean of |volume kept - 1|",
        best: Best::Low,
        decimals: 1,
        value: |s| s.kept_off.map(|k| k * 100.0),
    },
    Measure {
        title: "thinnest wall",
        unit: "mm",
        says: "at any time",
        best: Best::High,
        decimals: 1,
        value: |s| s.min_wall_mm,
    },
    Measure {
        title: "largest step",
        unit: "mm",
        says: "Hausdorff distance between neighbouring frames",
        best: Best::Low,
        decimals: 1,
        value: |s| s.step_max_mm,
    },
    Measure {
        title: "unevenness",
        unit: "",
        says: "largest over mean step per t; 1 is even motion",
        best: Best::Low,
        decimals: 2,
        value: |s| s.unevenness,
    },
    Measure {
        title: "stray",
        unit: "mm",
        says: "largest distance to the nearer parent",
        best: Best::Low,
        decimals: 1,
        value: |s| s.stray_mm,
    },
    Measure {
        title: "gradient error",
        unit: "",
        says: "mean of | |grad f| - 1 | on the surface",
        best: Best::Low,
        decimals: 3,
        value: |s| s.gradient_error,
    },
    Measure {
        title: "time",
        unit: "s",
        says: "all frames, from the sampled parents to the meshes",
        best: Best::Low,
        decimals: 2,
        value: |s| s.seconds,
    },
    Measure {
        title: "peak memory",
        unit: "MB",
        says: "largest resident set while a frame was made",
        best: Best::Low,
        decimals: 0,
        value: |s| s.peak_mb,
    },
];

impl Measure {
    /// The value as it is shown, without its unit.
    pub fn text(&self, s: &Summary) -> Option<String> {
        (self.value)(s).map(|v| format!("{v:.*}", self.decimals))
    }

    /// Which methods win: those whose shown value is the best of the complete ones; none where all
    /// are equal, for then there is nothing to win.
    pub fn winners(&self, all: &[Summary]) -> Vec<bool> {
        let merit = |s: &Summary| -> Option<f64> {
            let v = self.text(s).filter(|_| s.complete())?.parse::<f64>().ok()?;
            Some(match self.best {
                Best::Low => -v,
                Best::High => v,
                Best::One => -(v - 1.0).abs(),
                Best::Neither => return None,
            })
        };
        let merits: Vec<Option<f64>> = all.iter().map(merit).collect();
        let best = merits.iter().flatten().copied().reduce(f64::max);
        let wins = |m: &Option<f64>| m.is_some() && *m == best;
        let all_win = merits.iter().flatten().all(|m| Some(*m) == best);
        merits.iter().map(|m| wins(m) && !all_win).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(t: f64, step: Option<f64>, pieces: u64) -> Row {
        Row { t, step_mm: step, pieces: Some(pieces), genus: Some(2), ..Row::default() }
    }

    #[test]
    fn steps_are_even_when_they_keep_pace_with_t() {
        let even = [row(0.0, None, 1), row(0.5, Some(4.0), 1), row(0.75, Some(2.0), 3)];
        let s = Summary::of("m", &even, 1);
        assert_eq!((s.unevenness, s.step_max_mm), (Some(1.0), Some(4.0)));
        assert_eq!((s.whole, s.pieces_max, s.extra_handles), (2, Some(3), Some(1)));
        let jump = [row(0.0, None, 1), row(0.5, Some(0.0), 1), row(1.0, Some(3.0), 1)];
        assert_eq!(Summary::of("m", &jump, 9).unevenness, Some(2.0));
        let still = [row(0.0, None, 1), row(1.0, Some(0.0), 1)];
        assert_eq!(Summary::of("m", &still, 0).unevenness, None);
    }

    #[test]
    fn only_complete_methods_win_and_ties_are_shared() {
        let make = |made: usize, step: f64| Summary {
            frames: 2,
            made,
            step_max_mm: Some(step),
            ..Summary::default()
        };
        let step = MEASURES.iter().find(|m| m.title == "largest step").unwrap();
        let all = [make(1, 1.0), make(2, 3.0), make(2, 3.04), make(2, 9.0)];
        assert_eq!(step.winners(&all), [false, true, true, false]);
        assert_eq!(step.winners(&all[..2]), [false, false], "alone, or all alike: no contest");
    }
}
