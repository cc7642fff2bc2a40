//! run (to come).
