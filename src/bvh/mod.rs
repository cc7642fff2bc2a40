//! bvh (to come).
