//! A network: the weights of its layers.

use super::super::network::Network;
use super::bytes::{Cursor, corrupt, put_u8};
use super::numbers;
use crate::error::Result;

/// Appends a network.
///
/// # Errors
/// When a number has no room there.
pub(super) fn put(out: &mut Vec<u8>, network: &Network) -> Result<()> {
    put_u8(out, u8::from(network.is_square));
    put_layers(out, network)
}

/// Appends the weights alone.
///
/// # Errors
/// When a number has no room there.
pub(super) fn put_layers(out: &mut Vec<u8>, network: &Network) -> Result<()> {
    network.tables().try_for_each(|(cols, table)| numbers::put(out, cols, &table))
}

/// Takes a network of a factor.
///
/// # Errors
/// When the bytes are none, or there is no room for it.
pub(super) fn take(cursor: &mut Cursor<'_>, factor: usize) -> Result<Network> {
    let is_square = cursor.flag("whether cells are square")?;
    take_layers(cursor, factor, is_square)
}

/// Takes a network of a factor whose weights alone were kept.
///
/// # Errors
/// When the bytes are none, or there is no room for it.
pub(super) fn take_layers(cursor: &mut Cursor<'_>, factor: usize, is_square: bool) -> Result<Network> {
    let sizes = Network::table_sizes(factor);
    let tables = sizes.into_iter().map(|size| numbers::take_finite(cursor, size, "the weights of a layer"));
    let tables = tables.collect::<Result<Vec<_>>>()?;
    Network::of_tables(factor, is_square, &tables).ok_or_else(|| corrupt("the layers of a network do not fit"))
}
