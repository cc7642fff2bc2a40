//! Entries in order of a small whole number and then of their own: sorting by counting, which for
//! the edges of a mesh takes a fraction of the time and half the memory of comparing.

/// Entries by bucket, each bucket in order.
pub(super) struct Buckets<T> {
    /// One past the last entry of every bucket.
    ends: Vec<u32>,
    all: Vec<T>,
}

impl<T: Copy + Default + Ord + Send> Buckets<T> {
    /// Sorts the entries that `list` gives, each with its bucket below `count`; fewer than 2³² in all.
    pub fn new<I: Iterator<Item = (u32, T)>>(count: usize, list: impl Fn() -> I) -> Self {
        let mut ends = vec![0u32; count];
        list().for_each(|(bucket, _)| ends[bucket as usize] += 1);
        let mut total = 0;
        for end in &mut ends {
            // where the bucket begins; filling it moves that to its end
            total += std::mem::replace(end, total);
        }
        let mut all = vec![T::default(); total as usize];
        for (bucket, entry) in list() {
            let place = &mut ends[bucket as usize];
            all[*place as usize] = entry;
            *place += 1;
        }
        sort(&ends, 0, &mut all);
        Self { ends, all }
    }

    /// The entries of each bucket.
    pub fn iter(&self) -> impl Iterator<Item = &[T]> {
        let starts = std::iter::once(&0).chain(&self.ends);
        starts.zip(&self.ends).map(|(&from, &to)| &self.all[from as usize..to as usize])
    }
}

/// Buckets sorted by one thread.
const AT_ONCE: usize = 1 << 14;

/// Sorts each bucket of `all`, which starts at entry `first`.
fn sort<T: Ord + Send>(ends: &[u32], first: u32, all: &mut [T]) {
    if ends.len() > AT_ONCE {
        let half = ends.len() / 2;
        let middle = ends[half - 1];
        let (low, high) = all.split_at_mut((middle - first) as usize);
        rayon::join(|| sort(&ends[..half], first, low), || sort(&ends[half..], middle, high));
        return;
    }
    let mut start = first;
    for &end in ends {
        all[(start - first) as usize..(end - first) as usize].sort_unstable();
        start = end;
    }
}

#[cfg(test)]
mod tests {
    use super::Buckets;

    #[test]
    fn sorts_by_bucket_and_then_by_entry() {
        let list = [(2, 5), (0, 9), (2, 1), (3, 3), (0, 4), (2, 5)];
        let sorted = Buckets::new(5, || list.into_iter());
        let got: Vec<&[u32]> = sorted.iter().collect();
        assert_eq!(got, [&[4, 9][..], &[], &[1, 5, 5], &[3], &[]]);
        let many = Buckets::new(100_000, || (0..400_000u32).rev().map(|i| (i % 100_000, i)));
        assert!(many.iter().enumerate().all(|(b, all)| {
            all.iter().enumerate().all(|(n, &i)| i as usize == b + 100_000 * n) && all.len() == 4
        }));
        assert_eq!(Buckets::<u32>::new(0, std::iter::empty).iter().count(), 0);
    }
}
