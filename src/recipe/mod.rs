//! recipe (to come).
