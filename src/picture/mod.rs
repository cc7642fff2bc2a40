//! picture (to come).
