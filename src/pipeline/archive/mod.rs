//! Jobs on `.oro` containers: from rasters of any format and back, and looking after them.
//!
//! [`encode`] and [`decode`] take a raster batch by batch: while the threads work on the tiles of one, the next is
//! read, or the last one written. What they write does not depend on threads or memory.

mod batch;
mod compare;
mod container;
pub mod decode;
mod dem;
pub mod encode;
mod input;
mod promise;
mod record;
mod stream;
mod tile_side;
pub mod verify;

pub use container::{ContainerOptions, ContainerSource, is_container};
pub use dem::{open_dem, open_dem_coarse};
pub(super) use input::Input;
pub use promise::Promise;
pub(super) use record::description_of;
pub(super) use stream::ByteStream;
pub use stream::Target;
pub(super) use tile_side::tile_side_of;
