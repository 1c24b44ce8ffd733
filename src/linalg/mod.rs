//! Vectors and matrices of the methods: sums with one order, products of large matrices, eigenvectors, equations.
//!
//! What must be equal on every machine is summed in `f64` in one fixed order ([`dot`], [`quadratic`], [`Gram`]). The
//! fast product ([`product`]) uses what the processor has, and its last bits depend on that. It may therefore only
//! propose: [`product_error`] says how far its values can be from the exact ones, and whoever needs the largest of
//! them decides between all that lie within that distance by sums with one order.

mod cholesky;
mod eigen;
mod gram;
mod octets;
mod product;
mod sum;
mod vectors;

pub(crate) use cholesky::solve;
pub(crate) use eigen::{eigenvectors, leading_eigenvector};
pub(crate) use gram::Gram;
pub(crate) use octets::{OctetWork, Octets, in_octets};
pub(crate) use product::{UNDERFLOW, product, product_error};
pub(crate) use sum::{dot, quadratic};
pub(crate) use vectors::vectorised;
