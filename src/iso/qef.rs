//! The point nearest to several planes, by least squares.

use glam::{DMat3, DVec3};

/// Singular values below this share of the largest count as none: flat directions keep the mean.
const TRUNCATE: f64 = 0.1;

/// How far from `mean` the point lies that minimises the sum of squared distances to the planes
/// through `points` with unit `normals`. Along directions that the planes do not determine it
/// stays at the mean (Kobbelt et al. 2001, section 3, with a truncated decomposition).
pub(super) fn offset(mean: DVec3, points: &[DVec3], normals: &[DVec3]) -> DVec3 {
    let (mut ata, mut atb) = (DMat3::ZERO, DVec3::ZERO);
    for (&p, &n) in points.iter().zip(normals) {
        ata += DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        atb += n * n.dot(p - mean);
    }
    let (values, vectors) = symmetric_eigen(ata);
    let least = values.max_element() * TRUNCATE * TRUNCATE;
    (0..3)
        .filter(|&a| values[a] > least)
        .map(|a| vectors.col(a) * (vectors.col(a).dot(atb) / values[a]))
        .sum()
}

/// Eigenvalues and, as columns, eigenvectors of a symmetric matrix, by Jacobi rotations.
fn symmetric_eigen(mut m: DMat3) -> (DVec3, DMat3) {
    let mut vectors = DMat3::IDENTITY;
    // three sweeps leave less than 1e-9 of the largest value off the diagonal; six are at round-off
    for _ in 0..6 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = m.col(p)[q];
            if off == 0.0 {
                continue;
            }
            let angle = 0.5 * (2.0 * off).atan2(m.col(q)[q] - m.col(p)[p]);
            let (s, c) = angle.sin_cos();
            let mut turn = DMat3::IDENTITY;
            turn.col_mut(p)[p] = c;
            turn.col_mut(q)[q] = c;
            turn.col_mut(q)[p] = s;
            turn.col_mut(p)[q] = -s;
            m = turn.transpose() * m * turn;
            vectors *= turn;
        }
    }
    (DVec3::new(m.col(0).x, m.col(1).y, m.col(2).z), vectors)
}

#[cfg(test)]
mod tests {
    use super::{offset, symmetric_eigen};
    use glam::{DMat3, DQuat, DVec3};

    #[test]
    fn eigenvectors_rebuild_the_matrix() {
        for n in 0..20 {
            let turn = DMat3::from_quat(DQuat::from_scaled_axis(
                DVec3::new(0.3, -1.0, 0.7) * f64::from(n),
            ));
            let values = DVec3::new(3.0, 0.2, f64::from(n % 3));
            let m = turn * DMat3::from_diagonal(values) * turn.transpose();
            let (found, vectors) = symmetric_eigen(m);
            let back = vectors * DMat3::from_diagonal(found) * vectors.transpose();
            assert!(back.abs_diff_eq(m, 1e-12), "{back} {m}");
        }
    }

    #[test]
    fn planes_meet_in_a_corner_an_edge_or_not() {
        let corner = DVec3::new(0.2, 0.5, -0.3);
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let on = |n: usize| corner + axes[(n + 1) % 3] * 0.4 - axes[(n + 2) % 3] * 0.7;
        let points = [on(0), on(1), on(2)];
        let mean = (points[0] + points[1] + points[2]) / 3.0;
        assert!((mean + offset(mean, &points, &axes)).abs_diff_eq(corner, 1e-12));
        // two planes: onto their line, nearest to the mean
        let to = offset(mean, &points[..2], &axes[..2]);
        assert!(to.abs_diff_eq((corner - mean) * DVec3::new(1.0, 1.0, 0.0), 1e-12));
        let to = offset(mean, &points[..1], &axes[..1]);
        assert!(to.abs_diff_eq((corner - mean) * DVec3::X, 1e-12));
        assert_eq!(offset(mean, &points, &[DVec3::ZERO; 3]), DVec3::ZERO);
    }
}
