//! Near-miss names: what a mistyped key was probably meant to be.

/// The candidate nearest to `word`, when it is near enough to be meant.
pub fn nearest<'a>(word: &str, among: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let most = 1 + word.chars().count() / 3;
    let lower = word.to_lowercase();
    among
        .into_iter()
        .map(|c| (distance(&lower, &c.to_lowercase()), c))
        // a word of which nothing is left was not meant
        .filter(|&(d, _)| d <= most && d < lower.chars().count())
        .min_by_key(|&(d, _)| d)
        .map(|(_, c)| c)
}

/// `; did you mean ...?`, or nothing.
pub fn did_you_mean<'a>(word: &str, among: impl IntoIterator<Item = &'a str>) -> String {
    nearest(word, among).map_or_else(String::new, |c| format!("; did you mean `{c}`?"))
}

/// Edits from `a` to `b`, a swap of neighbours counted once (optimal string alignment).
fn distance(a: &str, b: &str) -> usize {
    // names are short; a file full of one long key must not cost its square
    let a: Vec<char> = a.chars().take(64).collect();
    let b: Vec<char> = b.chars().take(64).collect();
    let mut older = vec![0; b.len() + 1];
    let mut old: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let differ = usize::from(a[i - 1] != b[j - 1]);
            row[j] = (old[j - 1] + differ).min(old[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(older[j - 2] + 1);
            }
        }
        older = std::mem::replace(&mut old, row);
    }
    old[b.len()]
}

#[cfg(test)]
mod tests {
    use super::{distance, nearest};

    #[test]
    fn counts_edits() {
        assert_eq!(distance("", "abc"), 3);
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("radius", "raduis"), 1);
    }

    #[test]
    fn names_what_is_near_and_nothing_else() {
        let keys = ["center", "size", "rotate_deg"];
        assert_eq!(nearest("centre", keys), Some("center"));
        assert_eq!(nearest("Size", keys), Some("size"));
        assert_eq!(nearest("banana", keys), None);
    }
}
