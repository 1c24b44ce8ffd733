//! The constrained Delaunay triangulation: the one place that knows `spade`.

use super::mesh::Mesh;
use crate::error::{Error, ErrorKind, Result};
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation as _};

/// A Delaunay triangulation of points, some of whose edges are given; its decisions are exact.
///
/// Points that lie on one circle are triangulated as their order has it, so equal input gives equal triangles.
#[derive(Debug)]
pub struct Triangulation {
    inner: Inner,
    /// The vertices in the order of their points.
    handles: Vec<FixedVertexHandle>,
}

type Inner = ConstrainedDelaunayTriangulation<Vertex>;

/// A point with its number.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    place: Point2<f64>,
    own: u32,
}

impl HasPosition for Vertex {
    type Scalar = f64;

    #[inline]
    fn position(&self) -> Point2<f64> {
        self.place
    }
}

/// A triangle of a triangulation with its vertices, counter-clockwise where x points right and y up.
pub(super) type Face = (usize, [u32; 3]);

impl Triangulation {
    /// The triangulation of `points`, all different, in which each of `edges` (pairs of positions) is an edge, or
    /// several where other points lie on it. Vertices have the positions of their points.
    ///
    /// # Errors
    /// Coordinates that are not finite or too small or large to reckon with, equal points, and edges that cross, named
    /// by their ends.
    ///
    /// # Panics
    /// When an edge names a point that is not there.
    pub fn new(points: &[[f64; 2]], edges: &[[u32; 2]]) -> Result<Self> {
        let own = |(own, &[x, y]): (u32, &[f64; 2])| Vertex { place: Point2::new(x, y), own };
        // Loading given edges at once would go through sets whose order differs from run to run.
        let mut inner: Inner =
            Inner::bulk_load((0..).zip(points).map(own).collect()).map_err(|error| unusable(&error))?;
        if inner.num_vertices() != points.len() {
            let message =
                format!("{} of {} points are equal to others", points.len() - inner.num_vertices(), points.len());
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        let mut handles = vec![FixedVertexHandle::from_index(0); points.len()];
        inner.vertices().for_each(|vertex| handles[vertex.data().own as usize] = vertex.fix());
        for &[a, b] in edges {
            let [from, to] = [a, b].map(|v| handles[v as usize]);
            if !inner.can_add_constraint(from, to) {
                let ([ax, ay], [bx, by]) = (points[a as usize], points[b as usize]);
                let message =
                    format!("the line from {ax}, {ay} to {bx}, {by} crosses another one between their points");
                return Err(Error::new(ErrorKind::Unsupported, message));
            }
            inner.try_add_constraint(from, to);
        }
        Ok(Self { inner, handles })
    }

    /// Number of vertices.
    pub fn vertices(&self) -> usize {
        self.inner.num_vertices()
    }

    /// Adds a point; a vertex near it spares the search. Returns the vertex.
    ///
    /// All triangles that change have the new vertex.
    ///
    /// # Errors
    /// Coordinates that are not finite or too small or large to reckon with, and a place where a vertex is already; the
    /// triangulation is of no more use then.
    pub fn insert(&mut self, [x, y]: [f64; 2], near: u32) -> Result<u32> {
        #[allow(clippy::cast_possible_truncation, reason = "spade counts vertices with 32 bits")]
        let own = self.handles.len() as u32;
        let vertex = Vertex { place: Point2::new(x, y), own };
        let handle =
            self.inner.insert_with_hint(vertex, self.handles[near as usize]).map_err(|error| unusable(&error))?;
        if handle.index() != self.handles.len() {
            return Err(Error::new(ErrorKind::Unsupported, format!("there is a vertex at {x}, {y} already")));
        }
        self.handles.push(handle);
        Ok(own)
    }

    /// Place of a vertex.
    #[inline]
    pub fn point(&self, vertex: u32) -> [f64; 2] {
        let place = self.inner.vertex(self.handles[vertex as usize]).position();
        [place.x, place.y]
    }

    /// Number of triangles, and of the outer face, which is face 0.
    pub(super) fn faces(&self) -> usize {
        self.inner.num_all_faces()
    }

    /// All triangles with their numbers.
    pub(super) fn numbered(&self) -> impl Iterator<Item = Face> + '_ {
        self.inner.inner_faces().map(|face| (face.index(), face.vertices().map(|vertex| vertex.data().own)))
    }

    /// The triangles around a vertex, in place of what is in `faces`.
    pub(super) fn star(&self, vertex: u32, faces: &mut Vec<Face>) {
        faces.clear();
        for edge in self.inner.vertex(self.handles[vertex as usize]).out_edges() {
            if edge.face().is_outer() {
                continue;
            }
            let next = edge.next();
            let triangle = [vertex, next.from().data().own, next.to().data().own];
            faces.push((edge.face().index(), triangle));
        }
    }

    /// All triangles.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.numbered().map(|(_, triangle)| triangle)
    }

    /// All edges, also where all points lie on one line and there is no triangle.
    pub fn edges(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.inner.undirected_edges().map(|edge| edge.vertices().map(|vertex| vertex.data().own))
    }

    /// Whether two vertices are the ends of an edge that was given, or of a part of one.
    pub fn is_given(&self, a: u32, b: u32) -> bool {
        let [a, b] = [a, b].map(|v| self.handles[v as usize]);
        self.inner.get_edge_from_neighbors(a, b).is_some_and(|edge| edge.is_constraint_edge())
    }

    /// The triangulation as a mesh, with the elevations `z` of the vertices.
    ///
    /// # Panics
    /// When there is not one elevation a vertex.
    pub fn mesh(&self, z: &[f64]) -> Mesh {
        assert_eq!(z.len(), self.vertices(), "one elevation a vertex");
        let place = |(v, &z): (u32, &f64)| {
            let [x, y] = self.point(v);
            [x, y, z]
        };
        let vertices = (0..).zip(z).map(place).collect();
        Mesh { vertices, triangles: self.triangles().collect() }
    }
}

fn unusable(error: &spade::InsertionError) -> Error {
    Error::new(ErrorKind::Unsupported, format!("a point cannot be triangulated: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [[f64; 2]; 5] = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [2.0, 2.0]];

    #[test]
    fn given_edges_are_edges() {
        let mut made = Triangulation::new(&SQUARE, &[[0, 2]]).unwrap();
        assert!(made.is_given(0, 4) && made.is_given(4, 2), "in two parts, as a point lies on it");
        assert!(!made.is_given(1, 4));
        assert_eq!(made.mesh(&[1.0; 5]).check(), Ok(()));
        let vertex = made.insert([1.0, 1.0], 0).unwrap();
        assert!(made.is_given(0, vertex) && made.is_given(vertex, 4), "and parted further");
        let mut star = Vec::new();
        made.star(vertex, &mut star);
        assert_eq!(star.len(), 4);
        for (face, [a, b, c]) in star {
            let (_, mut known) = made.numbered().find(|known| known.0 == face).unwrap();
            let first = known.iter().position(|&v| v == a).unwrap();
            known.rotate_left(first);
            assert_eq!(known, [a, b, c]);
        }
    }

    #[test]
    fn what_cannot_be_triangulated_is_refused() {
        let refused =
            |points: &[[f64; 2]], edges: &[[u32; 2]]| Triangulation::new(points, edges).unwrap_err().to_string();
        let crossing = refused(&SQUARE[..4], &[[0, 2], [1, 3]]);
        assert!(crossing.contains("crosses another one"), "{crossing}");
        let infinite = refused(&[[0.0, 0.0], [f64::NAN, 1.0]], &[]);
        assert!(infinite.contains("cannot be triangulated"), "{infinite}");
        let mut made = Triangulation::new(&SQUARE, &[]).unwrap();
        assert!(made.insert([4.0, 4.0], 0).unwrap_err().to_string().contains("already"));
        let equal = refused(&[[0.0, 0.0], [1.0, 1.0], [0.0, 0.0]], &[]);
        assert!(equal.contains("1 of 3 points"), "{equal}");
    }
}
