//! check (to come).
