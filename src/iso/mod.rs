//! iso (to come).
