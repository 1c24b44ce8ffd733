//! The `.oro` container through its public door, without the program.

#![allow(unreachable_pub, reason = "modules of a test binary say what they offer to each other")]

mod case;
mod damage;
mod opening;
mod round_trips;
mod sections;
mod sizes;
