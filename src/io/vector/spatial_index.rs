//! The spatial index of a GeoPackage layer, packed in one go.
//!
//! GDAL and SQLite insert the features into the R-tree one after the other, which takes longer than writing the
//! features themselves. Here the tree is packed by sort-tile-recursive (Leutenegger et al. 1997,
//! doi:10.1109/ICDE.1997.582015) and written as the nodes that SQLite keeps in the table's shadow tables, whose layout
//! its documentation gives ("The SQLite R*Tree Module", section 6): a node is a blob that begins with two bytes for
//! the depth of the tree (in the root) and two for the number of cells; a cell is the 64-bit number of a child node or
//! of a row and the least and greatest x and y as 32-bit floats, all big-endian.

use gdal::Dataset;
use gdal::errors::Result;
use gdal::vector::LayerAccess;
use gdal::vector::sql::Dialect;
use std::fmt::Write;

/// Least x, greatest x, least y, greatest y.
pub(super) type Bounds = [f64; 4];

/// Bytes of a cell.
const CELL: usize = 24;

/// Bytes of SQL in one statement, about; SQLite takes a million.
const STATEMENT: usize = 400_000;

/// A spatial index that is being prepared while features are written.
pub(super) struct SpatialIndex {
    table: String,
    /// Definitions of the triggers that would keep the index up to date; they come back at the end.
    triggers: Vec<(String, String)>,
    /// Bounds of the features in the order of their numbers, from 1.
    bounds: Vec<Bounds>,
}

impl SpatialIndex {
    /// Creates the index of a layer that has no features yet, and puts its triggers to sleep.
    pub(super) fn begin(dataset: &Dataset, layer: &str) -> Result<Self> {
        run(dataset, &format!("SELECT CreateSpatialIndex({}, 'geom')", quoted(layer)))?;
        let query = format!(
            "SELECT name, sql FROM sqlite_master WHERE type = 'trigger' AND name LIKE 'rtree_%' AND tbl_name = {} ORDER BY name",
            quoted(layer)
        );
        let mut triggers = Vec::new();
        if let Some(mut rows) = dataset.execute_sql(query, None, Dialect::DEFAULT)? {
            for row in rows.features() {
                if let (Some(name), Some(sql)) = (row.field_as_string(0)?, row.field_as_string(1)?) {
                    triggers.push((name, sql));
                }
            }
        }
        for (name, _) in &triggers {
            run(dataset, &format!("DROP TRIGGER \"{name}\""))?;
        }
        Ok(Self { table: format!("rtree_{layer}_geom"), triggers, bounds: Vec::new() })
    }

    /// Adds the next feature.
    pub(super) fn add(&mut self, bounds: Bounds) {
        self.bounds.push(bounds);
    }

    /// Writes the index and wakes the triggers.
    pub(super) fn finish(self, dataset: &Dataset) -> Result<()> {
        let Self { table, triggers, bounds } = self;
        let mut node_bytes = 0;
        let query = format!("SELECT length(data) FROM \"{table}_node\" WHERE nodeno = 1");
        if let Some(mut rows) = dataset.execute_sql(query, None, Dialect::DEFAULT)? {
            for row in rows.features() {
                node_bytes = row.field_as_integer(0)?.unwrap_or(0) as usize;
            }
        }
        let tree = Packed::new(&bounds, node_bytes.saturating_sub(4) / CELL);
        run(dataset, &format!("DELETE FROM \"{table}_node\""))?;
        let nodes = tree.nodes.iter().zip(1..).map(|(node, number)| {
            let depth = if number == 1 { tree.depth } else { 0 };
            format!("({number},x'{}')", hex(&node.bytes(depth, node_bytes)))
        });
        insert(dataset, &format!("\"{table}_node\""), nodes)?;
        insert(
            dataset,
            &format!("\"{table}_parent\""),
            tree.parents().map(|(child, parent)| format!("({child},{parent})")),
        )?;
        insert(
            dataset,
            &format!("\"{table}_rowid\""),
            tree.rows().into_iter().map(|(row, node)| format!("({row},{node})")),
        )?;
        triggers.iter().try_for_each(|(_, sql)| run(dataset, sql))
    }
}

fn run(dataset: &Dataset, sql: &str) -> Result<()> {
    dataset.execute_sql(sql, None, Dialect::DEFAULT).map(|_| ())
}

fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', "''"))
}

/// Inserts rows, many with each statement.
fn insert(dataset: &Dataset, table: &str, rows: impl Iterator<Item = String>) -> Result<()> {
    let mut sql = String::new();
    for row in rows {
        if sql.is_empty() {
            let _ = write!(sql, "INSERT INTO {table} VALUES {row}");
        } else {
            let _ = write!(sql, ",{row}");
        }
        if sql.len() > STATEMENT {
            run(dataset, &sql)?;
            sql.clear();
        }
    }
    if sql.is_empty() { Ok(()) } else { run(dataset, &sql) }
}

fn hex(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 16] = b"0123456789abcdef";
    bytes.iter().flat_map(|byte| [DIGITS[(byte >> 4) as usize] as char, DIGITS[(byte & 15) as usize] as char]).collect()
}

/// A node: the rows, or the nodes, that it holds.
#[derive(Clone, Debug)]
struct Node {
    /// Number and bounds of each entry.
    entries: Vec<(i64, Bounds)>,
}

impl Node {
    fn bounds(&self) -> Bounds {
        let mut all = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        for (_, b) in &self.entries {
            all = [all[0].min(b[0]), all[1].max(b[1]), all[2].min(b[2]), all[3].max(b[3])];
        }
        all
    }

    fn bytes(&self, depth: u16, length: usize) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(length);
        bytes.extend_from_slice(&depth.to_be_bytes());
        bytes.extend_from_slice(&(self.entries.len() as u16).to_be_bytes());
        for (number, [x0, x1, y0, y1]) in &self.entries {
            bytes.extend_from_slice(&number.to_be_bytes());
            for value in [down(*x0), up(*x1), down(*y0), up(*y1)] {
                bytes.extend_from_slice(&value.to_be_bytes());
            }
        }
        bytes.resize(length, 0);
        bytes
    }
}

/// The greatest single-precision number that is not above a value.
fn down(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) > value { near.next_down() } else { near }
}

/// The least single-precision number that is not below a value.
fn up(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) < value { near.next_up() } else { near }
}

/// A packed tree: node 1 is the root.
struct Packed {
    nodes: Vec<Node>,
    /// Levels of nodes above the leaves.
    depth: u16,
    /// Position in `nodes` of the first leaf; leaves come last.
    first_leaf: usize,
}

impl Packed {
    fn new(bounds: &[Bounds], capacity: usize) -> Self {
        let capacity = capacity.max(2);
        let entries = (1..).zip(bounds.iter().copied()).collect();
        // From the leaves up; then numbered from the root down.
        let mut levels = vec![pack(entries, capacity)];
        while let Some(below) = levels.last().filter(|level| level.len() > 1) {
            let entries = (0..).zip(below.iter().map(Node::bounds)).collect();
            levels.push(pack(entries, capacity));
        }
        levels.reverse();
        let depth = (levels.len() - 1) as u16;
        let mut nodes: Vec<Node> = Vec::new();
        let mut first_leaf = 0;
        let total = levels.len();
        for (i, level) in levels.into_iter().enumerate() {
            // Children come right after their level, in their order there.
            let next = (nodes.len() + level.len() + 1) as i64;
            if i + 1 == total {
                first_leaf = nodes.len();
            }
            nodes.extend(level.into_iter().map(|mut node| {
                if i + 1 < total {
                    node.entries.iter_mut().for_each(|(number, _)| *number += next);
                }
                node
            }));
        }
        Self { nodes, depth, first_leaf }
    }

    /// Number of each node but the root, with that of its parent.
    fn parents(&self) -> impl Iterator<Item = (i64, i64)> {
        let inner = self.nodes[..self.first_leaf].iter().zip(1..);
        inner.flat_map(|(node, parent)| node.entries.iter().map(move |&(child, _)| (child, parent)))
    }

    /// Number of each row, in rising order, with that of its leaf.
    fn rows(&self) -> Vec<(i64, i64)> {
        let leaves = self.nodes.iter().zip(1..).skip(self.first_leaf);
        let mut rows: Vec<_> =
            leaves.flat_map(|(node, leaf)| node.entries.iter().map(move |&(row, _)| (row, leaf))).collect();
        rows.sort_unstable();
        rows
    }
}

/// Packs entries into as few nodes as can be: slices of equal numbers by x, and in each slice by y.
fn pack(mut entries: Vec<(i64, Bounds)>, capacity: usize) -> Vec<Node> {
    let nodes = entries.len().div_ceil(capacity).max(1);
    let slices = (nodes as f64).sqrt().ceil() as usize;
    let slice = nodes.div_ceil(slices) * capacity;
    entries.sort_unstable_by(|(i, a), (j, b)| (a[0] + a[1]).total_cmp(&(b[0] + b[1])).then(i.cmp(j)));
    let mut packed = Vec::with_capacity(nodes);
    for slice in entries.chunks_mut(slice) {
        slice.sort_unstable_by(|(i, a), (j, b)| (a[2] + a[3]).total_cmp(&(b[2] + b[3])).then(i.cmp(j)));
        packed.extend(slice.chunks(capacity).map(|entries| Node { entries: entries.to_vec() }));
    }
    if packed.is_empty() {
        packed.push(Node { entries: Vec::new() });
    }
    packed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_in_one_leaf_and_inside_all_bounds_above() {
        for n in [0_usize, 1, 50, 51, 52, 700, 3000] {
            let point = |i: usize| ((i * 7919 % 1009) as f64 / 3.0, (i * 104_729 % 997) as f64 / 7.0);
            let bounds: Vec<Bounds> = (0..n).map(|i| point(i)).map(|(x, y)| [x, x, y, y]).collect();
            let tree = Packed::new(&bounds, 51);
            let rows = tree.rows();
            assert!(rows.iter().map(|r| r.0).eq(1..=n as i64), "{n}: every row once");
            for (child, parent) in tree.parents() {
                let inner = tree.nodes[child as usize - 1].bounds();
                let entry = tree.nodes[parent as usize - 1].entries.iter().find(|e| e.0 == child).unwrap();
                assert_eq!(entry.1, inner, "{n}: the parent knows the bounds of node {child}");
            }
            assert_eq!(tree.parents().count(), tree.nodes.len() - 1, "{n}: one parent each");
            assert!(tree.nodes.iter().all(|node| node.entries.len() <= 51), "{n}: no node is too full");
        }
    }

    #[test]
    fn single_precision_bounds_hold_the_value() {
        for value in [0.1, -0.1, 9.600_138_9, 1e-50, 412_209.3, -7e9] {
            assert!(f64::from(down(value)) <= value && value <= f64::from(up(value)), "{value}");
        }
    }
}
