//! The `.oro` container through its public door, without the program.

#![allow(unreachable_pub, reason = "modules of a test binary say what they offer to each other")]

mod accepted;
mod case;
mod damage;
mod opening;
mod parts;
mod rejected;
mod round_trips;
mod sections;
mod sizes;
mod sparse;
mod sparse_vectors;
mod terrain;
mod tile_bits;
mod vectors;
mod worked;
