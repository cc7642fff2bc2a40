//! Which of many keys are the same.

use rayon::prelude::*;

/// No key.
const NONE: u32 = u32::MAX;

/// For each key the first that is the same.
pub(super) fn firsts(count: usize, key: impl Fn(u32) -> [u32; 3] + Send + Sync) -> Vec<u32> {
    let keys: Vec<[u32; 3]> = (0..count as u32).into_par_iter().map(key).collect();
    let mut table = vec![NONE; (2 * count).next_power_of_two()];
    let last = table.len() - 1;
    let mut firsts = vec![0; count];
    for (i, key) in keys.iter().enumerate() {
        let mut slot = hash(*key) as usize & last;
        // Half of the table stays empty, so that the search ends.
        while table[slot] != NONE && keys[table[slot] as usize] != *key {
            slot = (slot + 1) & last;
        }
        if table[slot] == NONE {
            table[slot] = i as u32;
        }
        firsts[i] = table[slot];
    }
    firsts
}

fn hash([a, b, c]: [u32; 3]) -> u64 {
    splitmix(splitmix(u64::from(a) << 32 | u64::from(b)) ^ u64::from(c))
}

/// A hash of all bits (the finaliser of SplitMix64).
pub(super) fn splitmix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_each_kind() {
        let keys = [7, 8, 7, 9, 8, 7].map(|k| [1, k, 2]);
        assert_eq!(firsts(keys.len(), |i| keys[i as usize]), [0, 1, 0, 3, 1, 0]);
        assert!(firsts(0, |_| [0; 3]).is_empty());
        // Cells of a grid, each met twice.
        let cell = |i: u32| [i % 1000 / 100, i % 100 / 10, i % 10];
        let found = firsts(2000, cell);
        assert!(found.iter().enumerate().all(|(i, &first)| first as usize == i % 1000));
    }
}
