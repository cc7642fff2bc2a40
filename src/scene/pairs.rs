//! Shapes read, and made fields, two at a time: what of one runs on a single core leaves the other core
//! to the other one.

use super::body::Body;
use super::live::Placed;
use crate::job::{Job, check};
use crate::recipe::{PlainOr, ShapeEntry};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

/// Two shapes above either are read, and made fields, one after the other: together they might take more
/// memory than all that comes after.
const FILE_BYTES: u64 = 16 << 20;
const FACES: usize = 100_000;

/// Whether little memory is needed to read a shape.
pub(super) fn is_short(entry: &ShapeEntry, beside: &Path) -> bool {
    let file = entry.mesh.as_ref().filter(|_| matches!(entry.place, PlainOr::Plain(_)));
    file.and_then(|f| beside.join(f).metadata().ok()).is_some_and(|m| m.len() <= FILE_BYTES)
}

/// Whether little memory is needed to make a shape's field.
pub(super) fn is_light(body: &Body) -> bool {
    matches!(body, Body::Mesh(mesh) if mesh.faces.len() <= FACES)
}

/// Faces of meshes whose fields are made at once, at most.
pub(super) fn faces_at_once(shapes: &[Placed]) -> usize {
    let faces = |p: &Placed| match &p.body {
        Body::Mesh(mesh) => mesh.faces.len(),
        _ => 0,
    };
    let alone = shapes.iter().map(faces);
    let pairs = shapes.windows(2).filter(|p| p.iter().all(|p| is_light(&p.body)));
    alone.chain(pairs.map(|p| p.iter().map(faces).sum())).max().unwrap_or(0)
}

/// One of two that are worked on at once: the job is told what both have done.
struct Half<'a> {
    job: &'a dyn Job,
    own: usize,
    /// As bits.
    shares: &'a [AtomicU64; 2],
}

impl Job for Half<'_> {
    fn cancelled(&self) -> bool {
        self.job.cancelled()
    }
    fn done(&self, share: f64) {
        self.shares[self.own].store(share.to_bits(), Ordering::Relaxed);
        let all = self.shares.each_ref().map(|s| f64::from_bits(s.load(Ordering::Relaxed)));
        self.job.done((all[0] + all[1]) / 2.0);
    }
}

/// Works on shapes in their order, on two neighbours at once where both are `light`. `stage` is what is
/// done with them, `name` what they are called.
///
/// # Errors
/// That of the first one that fails.
pub(super) fn in_pairs<T: Send, R: Send, E: Send + From<crate::job::Cancelled>>(
    items: Vec<T>,
    (stage, name): (&str, impl Fn(&T) -> &str),
    light: impl Fn(&T) -> bool,
    job: &dyn Job,
    work: impl Fn(T, &dyn Job) -> Result<R, E> + Sync,
) -> Result<Vec<R>, E> {
    let mut done = Vec::with_capacity(items.len());
    let mut items = items.into_iter().peekable();
    while let Some(a) = items.next() {
        check(job)?;
        let next = if light(&a) { items.next_if(|b| light(b)) } else { None };
        let Some(b) = next else {
            job.stage(&format!("{stage} {}", name(&a)));
            done.push(work(a, job)?);
            continue;
        };
        job.stage(&format!("{stage} {}, {}", name(&a), name(&b)));
        let shares = [const { AtomicU64::new(0) }; 2];
        let half = |own| Half { job, own, shares: &shares };
        let (a, b) = rayon::join(|| work(a, &half(0)), || work(b, &half(1)));
        done.extend([a?, b?]);
    }
    Ok(done)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::{Cancelled, Quiet};
    use std::sync::Mutex;

    /// Remembers what it is told.
    #[derive(Default)]
    struct Told(Mutex<(Vec<String>, Vec<f64>)>);

    impl Job for Told {
        fn stage(&self, name: &str) {
            self.0.lock().unwrap().0.push(name.to_owned());
        }
        fn done(&self, share: f64) {
            self.0.lock().unwrap().1.push(share);
        }
    }

    fn squares(of: &[i32], job: &dyn Job) -> Result<Vec<i32>, Result<i32, Cancelled>> {
        let names: Vec<String> = of.iter().map(|n| format!("n{n}")).collect();
        let items: Vec<(&str, i32)> =
            names.iter().map(String::as_str).zip(of.iter().copied()).collect();
        in_pairs(
            items,
            ("square", |i| i.0),
            |i| i.1 < 100,
            job,
            |(_, n), job| {
                job.done(1.0);
                if n < 0 { Err(Failed(n)) } else { Ok(n * n) }
            },
        )
        .map_err(|Failed(n)| Ok(n))
    }

    struct Failed(i32);

    impl From<Cancelled> for Failed {
        fn from(_: Cancelled) -> Self {
            Self(i32::MIN)
        }
    }

    #[test]
    fn what_is_light_goes_in_pairs_and_all_keeps_its_order() {
        let told = Told::default();
        assert_eq!(squares(&[1, 2, 3, 100, 4, 5], &told).unwrap(), [1, 4, 9, 10_000, 16, 25]);
        let (stages, shares) = told.0.into_inner().unwrap();
        assert_eq!(stages, ["square n1, n2", "square n3", "square n100", "square n4, n5"]);
        assert_eq!(shares.len(), 6);
        // a half of a pair, then both; alone the whole
        assert_eq!(shares.iter().filter(|&&s| s == 0.5).count(), 2);
    }

    #[test]
    fn the_first_that_fails_is_told() {
        assert_eq!(squares(&[1, -2, -3], &Quiet), Err(Ok(-2)));
        assert_eq!(squares(&[-1, -2, 3], &Quiet), Err(Ok(-1)));
    }

    struct Stopped;

    impl Job for Stopped {
        fn cancelled(&self) -> bool {
            true
        }
    }

    #[test]
    fn nothing_is_begun_once_cancelled() {
        assert_eq!(squares(&[1, 2], &Stopped), Err(Ok(i32::MIN)));
    }
}
