use super::{Deform, WarpError};
use crate::num::Aabb;
use glam::{DVec2, DVec3};

/// Nearest the axis of a bend may come to the body: curvature times reach. At 1 the inner side of
/// the body would shrink to a line and the inverse would not exist; 0.95 keeps its stretch at 20.
const TIGHTEST: f64 = 0.95;

/// A [`Deform`] made ready for a body of known half sizes (mm, before the deformation).
///
/// Beyond the ends of the body taper and twist keep their end values and the bend goes on straight,
/// so the map is continuous everywhere. Its inverse is continuous but on the far side of the bend
/// axis, where the two straight ends meet; the bounds below know that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Barr {
    half_length: f64,
    /// Turn per mm of z.
    twist: f64,
    /// Growth of the section per mm of z; the section is 1 at z = 0.
    slope: f64,
    /// One over the radius of the bent axis, signed.
    curvature: f64,
    /// Farthest the tapered and twisted body reaches in y.
    reach: f64,
}

/// A ball that a map has been applied to: it encloses the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Centre, mm.
    pub centre: DVec3,
    /// Radius, mm.
    pub radius: f64,
    /// No less than the 2-norm of the Jacobian of all maps so far; infinite across a tear.
    pub stretch: f64,
}

impl Ball {
    /// A ball that nothing has been applied to.
    pub fn new(centre: DVec3, radius: f64) -> Self {
        Self { centre, radius, stretch: 1.0 }
    }

    /// The ball after a map that takes the centre to `centre` and stretches by at most `by`.
    pub fn through(self, centre: DVec3, by: f64) -> Self {
        Self { centre, radius: self.radius * by, stretch: self.stretch * by }
    }
}

/// What a distance to a deformed body must know: near the body (closer than `cap`, mm, before the
/// deformation) the inverse map stretches by no more than `stretch`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Near {
    pub stretch: f64,
    pub cap: f64,
}

impl Barr {
    /// Ready for a body of these half sizes. A bend too tight for the body is eased to the tightest
    /// one it can have; [`Barr::check`] tells.
    pub fn new(deform: &Deform, half: DVec3) -> Self {
        let half_length = half.z;
        let ratio = (deform.taper - 1.0) / (deform.taper + 1.0);
        let mut barr = Self {
            half_length,
            twist: deform.twist * 0.5 / half_length,
            slope: ratio / half_length,
            curvature: 0.0,
            reach: 0.0,
        };
        let side = if deform.twist == 0.0 { half.y } else { half.x.hypot(half.y) };
        barr.reach = side * barr.widest();
        let most = TIGHTEST / barr.reach;
        barr.curvature = (deform.bend * 0.5 / half_length).clamp(-most, most);
        barr
    }

    /// Whether the bend leaves its axis outside a body of these half sizes.
    pub fn check(deform: &Deform, half: DVec3) -> Result<(), WarpError> {
        let most = 2.0 * half.z * TIGHTEST / Self::new(deform, half).reach;
        if deform.bend.abs() > most {
            return Err(WarpError::Thick { bend: deform.bend, most });
        }
        Ok(())
    }

    /// Where a point of the straight body goes.
    pub fn push(&self, v: DVec3) -> DVec3 {
        let z = self.clamp(v.z);
        let turned = DVec2::from_angle(self.twist * z).rotate(v.truncate() * self.section(z));
        let (y, z) = self.bend(turned.y, v.z);
        DVec3::new(turned.x, y, z)
    }

    /// Where a point of the deformed body came from; the inverse of [`Barr::push`].
    pub fn pull(&self, v: DVec3) -> DVec3 {
        let (y, z) = self.unbend(v.y, v.z);
        let at = self.clamp(z);
        let turned = DVec2::from_angle(-self.twist * at).rotate(DVec2::new(v.x, y));
        (turned / self.section(at)).extend(z)
    }

    /// The image of a ball under [`Barr::push`].
    pub fn push_ball(&self, b: Ball) -> Ball {
        let (size, slope) = self.sections(&b);
        let wide = perp(&b);
        let b1 = b.through(self.tapered(b.centre), triangle(size.y, wide * slope));
        let b2 = b1.through(self.twisted(b1.centre), self.twist_norm(&b1));
        let k = self.curvature;
        let across = (1.0 - k * b2.centre.y).abs() + k.abs() * b2.radius;
        let (y, z) = self.bend(b2.centre.y, b2.centre.z);
        b2.through(DVec3::new(b2.centre.x, y, z), across.max(1.0))
    }

    /// The image of a ball under [`Barr::pull`].
    pub fn pull_ball(&self, b: Ball) -> Ball {
        let b1 = self.unbend_ball(b);
        let z = self.clamp(b1.centre.z);
        let back = DVec2::from_angle(-self.twist * z).rotate(b1.centre.truncate());
        let b2 = b1.through(back.extend(b1.centre.z), self.twist_norm(&b1));
        let (size, slope) = self.sections(&b2);
        // METHODS D: the inverse taper has the section 1/rho and the shear |x_perp| rho' / rho²
        let norm = triangle(1.0 / size.x, perp(&b2) * slope / (size.x * size.x));
        b2.through((back / self.section(z)).extend(b1.centre.z), norm)
    }

    /// A box round the deformed body of half sizes `half`.
    pub fn bounds(&self, half: DVec3) -> Aabb {
        let wide = self.widest();
        let x = wide * if self.twist == 0.0 { half.x } else { half.x.hypot(half.y) };
        let k = self.curvature.abs();
        if k == 0.0 {
            return Aabb::around(DVec3::ZERO, DVec3::new(x, self.reach, half.z));
        }
        // polar about the bend axis: radius 1/k -+ reach, angle up to `end`
        let (inner, outer) = (1.0 / k - self.reach, 1.0 / k + self.reach);
        let end = k * self.half_length;
        let high = 1.0 / k - end.cos() * if end.cos() >= 0.0 { inner } else { outer };
        let long = outer * end.min(std::f64::consts::FRAC_PI_2).sin();
        let (low, high) = (-self.reach, high.max(self.reach));
        let (low, high) = if self.curvature > 0.0 { (low, high) } else { (-high, -low) };
        Aabb::new(DVec3::new(-x, low, -long), DVec3::new(x, high, long))
    }

    /// The neighbourhood of a body of half sizes `half` in which [`Barr::pull`] behaves.
    ///
    /// The stretch of twist and taper grows with the distance from the axis, that of the bend near
    /// its own axis, and the inverse bend tears behind that. All of it lies farther than `cap` from
    /// the body in straight coordinates, so a distance divided by `stretch` and cut off at
    /// `cap / stretch` is 1-Lipschitz over all of space.
    pub(crate) fn near(&self, half: DVec3) -> Near {
        let mut near = Near { stretch: 1.0, cap: f64::INFINITY };
        let widest = self.widest();
        let body = half.x.hypot(half.y);
        if self.twist != 0.0 || self.slope != 0.0 {
            let room = 1.5 * body;
            near.cap = room - body;
            let thin = 2.0 - widest;
            near.stretch *= twist_norm(self.twist, room * widest);
            near.stretch *= triangle(1.0 / thin, room * self.slope.abs() / thin);
        }
        let k = self.curvature.abs();
        if k > 0.0 {
            let room = (2.0 * self.reach).min(0.5 * (self.reach + 1.0 / k));
            near.stretch *= 1.0 / (1.0 - k * room);
            near.cap = near.cap.min((room - self.reach) / widest);
            // half the angle of the wedge that the straight ends share
            let wedge = std::f64::consts::PI - k * self.half_length;
            if wedge < std::f64::consts::FRAC_PI_2 {
                near.cap = near.cap.min((1.0 / k - room) * wedge.max(0.0).tan());
            }
        }
        near
    }

    fn clamp(&self, z: f64) -> f64 {
        z.clamp(-self.half_length, self.half_length)
    }

    /// Size of the section at a clamped z; 1 in the middle.
    fn section(&self, z: f64) -> f64 {
        1.0 + self.slope * z
    }

    /// Size of the section at the thick end.
    fn widest(&self) -> f64 {
        1.0 + (self.slope * self.half_length).abs()
    }

    fn tapered(&self, v: DVec3) -> DVec3 {
        (v.truncate() * self.section(self.clamp(v.z))).extend(v.z)
    }

    fn twisted(&self, v: DVec3) -> DVec3 {
        DVec2::from_angle(self.twist * self.clamp(v.z)).rotate(v.truncate()).extend(v.z)
    }

    /// METHODS H with y and z exchanged, written so that nothing is lost as the curvature vanishes.
    fn bend(&self, y: f64, z: f64) -> (f64, f64) {
        let k = self.curvature;
        if k == 0.0 {
            return (y, z);
        }
        let on = self.clamp(z);
        let (sin, cos) = (k * on).sin_cos();
        let half = (k * on * 0.5).sin();
        let beyond = z - on;
        (y * cos + 2.0 * half * half / k + sin * beyond, sin / k - y * sin + cos * beyond)
    }

    fn unbend(&self, y: f64, z: f64) -> (f64, f64) {
        let k = self.curvature;
        if k == 0.0 {
            return (y, z);
        }
        let end = (k * self.half_length).abs();
        let free = (k * z).atan2(1.0 - k * y);
        if free.abs() <= end {
            let radius = (k * z).hypot(1.0 - k * y);
            return ((2.0 * y - k * (z * z + y * y)) / (1.0 + radius), free / k);
        }
        let angle = free.clamp(-end, end);
        let (sin, cos) = angle.sin_cos();
        let half = (angle * 0.5).sin();
        let across = y * cos + 2.0 * half * half / k - z * sin;
        (across, angle / k + z * cos + y * sin - sin / k)
    }

    fn unbend_ball(&self, b: Ball) -> Ball {
        let k = self.curvature.abs();
        if k == 0.0 {
            return b;
        }
        let axis = 1.0 / self.curvature;
        let far = (b.centre.y - axis).hypot(b.centre.z);
        let behind = (b.centre.y * self.curvature.signum() + b.radius) * k >= 1.0;
        if far <= b.radius || (behind && b.centre.z.abs() <= b.radius) {
            let reach = far + b.radius;
            return Ball {
                centre: DVec3::new(b.centre.x, axis, 0.0),
                radius: DVec3::new(b.radius, reach, self.half_length + reach).length(),
                stretch: f64::INFINITY,
            };
        }
        let (y, z) = self.unbend(b.centre.y, b.centre.z);
        let angle = (self.curvature * b.centre.z).atan2(1.0 - self.curvature * b.centre.y).abs();
        let straight = angle - (b.radius / far).asin() >= k * self.half_length;
        let norm = if straight { 1.0 } else { (1.0 / (k * (far - b.radius))).max(1.0) };
        b.through(DVec3::new(b.centre.x, y, z), norm)
    }

    fn twist_norm(&self, b: &Ball) -> f64 {
        if self.beyond(b) { 1.0 } else { twist_norm(self.twist, perp(b)) }
    }

    /// Smallest and largest section over the ball, and how fast the section changes there.
    fn sections(&self, b: &Ball) -> (DVec2, f64) {
        let low = self.section(self.clamp(b.centre.z - b.radius));
        let high = self.section(self.clamp(b.centre.z + b.radius));
        let slope = if self.beyond(b) { 0.0 } else { self.slope.abs() };
        (DVec2::new(low.min(high), low.max(high)), slope)
    }

    /// Whether the whole ball lies past one end, where the section neither grows nor turns.
    fn beyond(&self, b: &Ball) -> bool {
        b.centre.z.abs() - b.radius >= self.half_length
    }
}

/// Farthest a ball reaches from the z axis.
fn perp(b: &Ball) -> f64 {
    b.centre.truncate().length() + b.radius
}

/// Norm of a twist of `rate` rad/mm at distance `r` from its axis (METHODS D).
fn twist_norm(rate: f64, r: f64) -> f64 {
    let a = rate.abs() * r;
    0.5 * (a + (a * a + 4.0).sqrt())
}

/// 2-norm of [[a, shear], [0, 1]], which also bounds a.
fn triangle(a: f64, shear: f64) -> f64 {
    let s = a * a + 1.0 + shear * shear;
    (0.5 * (s + (s * s - 4.0 * a * a).max(0.0).sqrt())).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const HALF: DVec3 = DVec3::new(20.0, 30.0, 200.0);

    fn deform() -> impl Strategy<Value = Deform> {
        let bend = prop_oneof![Just(0.0), Just(1e-9), -5.0..5.0f64];
        let twist = prop_oneof![Just(0.0), -3.0..3.0f64];
        (twist, 0.4..2.5f64, bend).prop_map(|(twist, taper, bend)| Deform { twist, taper, bend })
    }

    fn point(half: DVec3) -> impl Strategy<Value = DVec3> {
        (-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64)
            .prop_map(move |(x, y, z)| DVec3::new(x, y, z) * half)
    }

    #[test]
    fn the_bend_is_an_arc() {
        // a quarter circle of length 400: radius 400 / (pi/2), ends turned by 45 degrees
        let barr = Barr::new(&Deform::new(0.0, 1.0, std::f64::consts::FRAC_PI_2).unwrap(), HALF);
        let r = 400.0 / std::f64::consts::FRAC_PI_2;
        let end = barr.push(DVec3::new(0.0, 0.0, 200.0));
        let s = std::f64::consts::FRAC_1_SQRT_2;
        assert!((end - DVec3::new(0.0, r * (1.0 - s), r * s)).length() < 1e-10);
        assert_eq!(barr.push(DVec3::ZERO), DVec3::ZERO);
    }

    #[test]
    fn taper_keeps_the_middle_and_its_ratio() {
        let barr = Barr::new(&Deform::new(0.0, 0.25, 0.0).unwrap(), HALF);
        let x = |z: f64| barr.push(DVec3::new(1.0, 0.0, z)).x;
        assert!((x(0.0) - 1.0).abs() < 1e-15);
        assert!((x(200.0) / x(-200.0) - 0.25).abs() < 1e-15);
        assert_eq!(x(200.0), x(900.0));
    }

    #[test]
    fn senseless_numbers_are_refused() {
        assert!(matches!(Deform::new(f64::NAN, 1.0, 0.0), Err(WarpError::Twist(_))));
        assert!(matches!(Deform::new(0.0, 0.0, 0.0), Err(WarpError::Taper(_))));
        assert!(matches!(Deform::new(0.0, 1.0, 6.3), Err(WarpError::Bend(_))));
        let thick = Deform::new(0.0, 1.0, 3.0).unwrap();
        assert!(Barr::check(&thick, DVec3::splat(50.0)).is_err());
        assert!(Barr::check(&thick, HALF).is_ok());
    }

    proptest! {
        #[test]
        fn pull_undoes_push(d in deform(), q in point(HALF * DVec3::new(1.2, 1.2, 1.6))) {
            let barr = Barr::new(&d, HALF);
            // farther out the ends of a strong bend overlap
            prop_assume!(q.z.abs() <= HALF.z || d.bend.abs() < 3.0);
            prop_assume!(barr.curvature.abs() * barr.reach < 0.75);
            prop_assert!((barr.pull(barr.push(q)) - q).length() < 1e-12 * HALF.z);
        }

        #[test]
        fn balls_enclose(d in deform(), c in point(HALF * 2.0), r in 0.1..150.0f64,
                         u in prop::collection::vec(point(DVec3::ONE), 40)) {
            let barr = Barr::new(&d, HALF);
            let b = Ball::new(c, r);
            let (there, back) = (barr.push_ball(b), barr.pull_ball(b));
            for u in u {
                let p = c + u.clamp_length_max(1.0) * r;
                prop_assert!(there.centre.distance(barr.push(p)) <= there.radius * (1.0 + 1e-9));
                prop_assert!(back.centre.distance(barr.pull(p)) <= back.radius * (1.0 + 1e-9));
            }
        }

        #[test]
        fn stretch_bounds_differences(d in deform(), c in point(HALF * 2.0), u in point(DVec3::ONE)) {
            let barr = Barr::new(&d, HALF);
            let h = 1e-4;
            let b = Ball::new(c, h);
            let step = u.clamp_length_max(1.0) * h;
            let push = (barr.push(c + step) - barr.push(c)).length();
            prop_assert!(push <= barr.push_ball(b).stretch * step.length() + 1e-9);
            let pull = (barr.pull(c + step) - barr.pull(c)).length();
            prop_assert!(pull <= barr.pull_ball(b).stretch * step.length() + 1e-9);
        }

        #[test]
        fn the_box_holds_the_body(d in deform(), q in point(HALF)) {
            let barr = Barr::new(&d, HALF);
            prop_assert!(barr.bounds(HALF).grow(1e-9).contains(barr.push(q)));
        }
    }
}
