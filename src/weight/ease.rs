/// A function of time u(t) from [0, 1] to [0, 1] (paper 001, section 3.1).
#[derive(Clone, Debug, PartialEq)]
pub enum Ease {
    /// The same value at every time.
    Number(f64),
    /// t^n; n = 1 is plain time, 1/n its opposite number.
    Power(f64),
    /// Piecewise linear through (t, u) pairs, t increasing.
    Table(Vec<[f64; 2]>),
}

impl Ease {
    /// u(t), clamped to [0, 1].
    pub fn at(&self, t: f64) -> f64 {
        let _ = t;
        todo!()
    }
}
