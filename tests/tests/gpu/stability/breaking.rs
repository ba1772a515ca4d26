//! What is broken must be noticed by every kind of check.
