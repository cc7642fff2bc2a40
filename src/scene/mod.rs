//! scene (to come).
