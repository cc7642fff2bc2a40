//! From a mesh to its field, stage by stage.

use super::buried::Surface;
use super::cut::Scale;
use super::inside::Inside;
use super::shells::{Shell, Shells};
use super::solid::Solid;
use super::soup::Soup;
use super::{
    MeshField, MeshFieldError, MeshOptions, MeshReport, Sheet, Sign, Thicken, Which, orient,
};
use crate::bvh::Bvh;
use crate::job::{Job, check};
use crate::mesh::TriMesh;
use crate::num::Aabb;
use glam::DVec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Lengths relative to the diagonal of the mesh's box.
///
/// `SLACK`: gaps below it are closed; 0.02 mm on a chair of 1 m, above what a file with six
/// digits rounds by and below what a printer makes. `RIM`: rims nearer than this are one.
const SLACK: f64 = 2e-5;
const OFFSET: f64 = 1e-5;
const RIM: f64 = 1e-6;
const FLOOR: f64 = 2e-4;
/// The least floor, in slacks: smaller pieces all look coplanar with what touches them.
const FLOOR_SLACKS: f64 = 8.0;

/// An open shell is solid but for holes if behind its faces the winding number is mostly at least
/// this, and as far from it on the other side. A box with one side missing has about 0.8.
const SOLID: f64 = 0.75;
/// Faces of an open shell that are looked at for that.
const PROBES: usize = 32;

/// A mesh in shells, with everything the stages share.
struct Work<'a> {
    soup: Soup,
    shells: Vec<Shell>,
    scale: Scale,
    options: &'a MeshOptions,
    report: MeshReport,
}

pub(super) fn field(
    mesh: &TriMesh,
    options: &MeshOptions,
    job: &dyn Job,
) -> Result<(MeshField, MeshReport), MeshFieldError> {
    let positive = |x: &f64| *x > 0.0 && x.is_finite();
    if let Some(Thicken { mm, .. }) = options.thicken.filter(|t| !positive(&t.mm)) {
        return Err(MeshFieldError::Thickness(mm));
    }
    if let Some(floor) = options.floor.filter(|f| !positive(f)) {
        return Err(MeshFieldError::Floor(floor));
    }
    if options.sign == Sign::Unsigned && options.thicken.is_none() {
        return Err(MeshFieldError::Unsigned);
    }
    let mut work = Work::new(mesh, options)?;
    check(job)?;
    let (solid, sheet) = match options.sign {
        Sign::Unsigned => (None, work.everything()),
        Sign::Winding => work.parts(job)?,
    };
    let report = work.report;
    if solid.is_none() && sheet.is_none() {
        let (open, shells) = (report.open_shells, report.shells);
        return Err(MeshFieldError::NoInside { open, shells });
    }
    Ok((MeshField { solid, sheet }, report))
}

impl<'a> Work<'a> {
    fn new(mesh: &TriMesh, options: &'a MeshOptions) -> Result<Self, MeshFieldError> {
        let mut soup = Soup::new(mesh)?;
        let diagonal = Aabb::of(soup.points.iter().copied()).size().length();
        let slack = SLACK * diagonal;
        let floor = options.floor.unwrap_or(FLOOR * diagonal).max(FLOOR_SLACKS * slack);
        let scale = Scale { slack, offset: OFFSET * diagonal, floor };
        let Shells { shells, flipped_faces } =
            Shells::new(&soup.points, &mut soup.faces, RIM * diagonal);
        let flipped_shells = orient::right(&soup.points, &mut soup.faces, &shells);
        let report = MeshReport {
            faces: mesh.faces.len(),
            degenerate_faces: soup.degenerate,
            duplicate_faces: soup.duplicates,
            shells: shells.len(),
            open_shells: shells.iter().filter(|s| !s.rim.is_empty()).count(),
            flipped_shells,
            flipped_faces,
            ..Default::default()
        };
        let mut work = Self { soup, shells, scale, options, report };
        work.measure(mesh.faces.len())?;
        Ok(work)
    }

    /// Areas and rims for the report.
    fn measure(&mut self, faces: usize) -> Result<(), MeshFieldError> {
        let all: f64 = self.soup.faces.iter().map(|f| self.area(f)).sum();
        let double: f64 = self.soup.double.iter().map(|f| self.area(f)).sum();
        let open = self.shells.iter().filter(|s| !s.rim.is_empty());
        let open: f64 =
            open.flat_map(|s| &s.faces).map(|&f| self.area(&self.soup.faces[f as usize])).sum();
        let rims = self.shells.iter().flat_map(|s| &s.rim);
        let length: f64 =
            rims.map(|&([a, b], n)| self.at(a).distance(self.at(b)) * f64::from(n)).sum();
        let area = all + double;
        if area <= 0.0 {
            return Err(MeshFieldError::Empty { faces });
        }
        let report = &mut self.report;
        report.area = area;
        // an empty sum is -0
        report.open_area_share = open / area + 0.0;
        report.double_area_share = double / area + 0.0;
        report.rim_length = length + 0.0;
        Ok(())
    }

    fn at(&self, v: u32) -> DVec3 {
        self.soup.points[v as usize]
    }

    fn corners(&self, f: &[u32; 3]) -> [DVec3; 3] {
        f.map(|v| self.at(v))
    }

    fn area(&self, f: &[u32; 3]) -> f64 {
        let [a, b, c] = self.corners(f);
        (b - a).cross(c - a).length() * 0.5
    }

    /// Every face as a sheet.
    fn everything(&mut self) -> Option<Sheet> {
        let all = self.soup.faces.iter().chain(&self.soup.double);
        let faces: Vec<_> = all.map(|f| self.corners(f)).collect();
        self.sheet(&faces)
    }

    fn sheet(&mut self, faces: &[[DVec3; 3]]) -> Option<Sheet> {
        let half = self.options.thicken?.mm * 0.5;
        self.report.thickened_faces = faces.len();
        (!faces.is_empty()).then(|| Sheet { faces: Bvh::new(faces), half })
    }

    /// The solid and the sheets.
    fn parts(&mut self, job: &dyn Job) -> Result<(Option<Solid>, Option<Sheet>), MeshFieldError> {
        let (closed, open): (Vec<&Shell>, Vec<&Shell>) =
            self.shells.iter().partition(|s| s.rim.is_empty());
        // a thickened sheet has its thickness; what it seems to enclose is arbitrary
        let open = if self.options.thicken.is_some() { self.holed(&open) } else { open };
        let used: Vec<u32> =
            closed.iter().chain(&open).flat_map(|s| s.faces.iter().copied()).collect();
        let faces: Vec<_> = used.iter().map(|&f| self.soup.faces[f as usize]).collect();
        let triangles: Vec<_> = faces.iter().map(|f| self.corners(f)).collect();
        let (inside, all) = if closed.is_empty() || open.is_empty() {
            Inside::over(&triangles, &self.rim(&open), !closed.is_empty())
        } else {
            rayon::join(|| self.inside(&closed, &open), || Arc::new(Bvh::new(&triangles)))
        };
        let surface = Surface::new(triangles, &faces, &all, &inside, self.scale, job)?;
        let mut sheets = self.sheets(&inside);
        if self.options.thicken.is_some_and(|t| t.which == Which::Open) {
            sheets.extend(&surface.sheets);
        }
        let sheet = self.sheet(&sheets);
        self.tell(&surface, sheet.is_some());
        let blur = if surface.contact_faces > 0 { 4.0 * self.scale.slack } else { 0.0 };
        let solid = (!surface.triangles.is_empty()).then(|| Solid::new(surface, inside, blur, all));
        Ok((solid, sheet))
    }

    fn tell(&mut self, surface: &Surface, thickened: bool) {
        let report = &mut self.report;
        report.solid = !surface.triangles.is_empty();
        report.buried_faces = surface.buried_faces;
        report.buried_area_share = surface.buried_area / report.area;
        let lost = surface.nothing_area / report.area + report.double_area_share;
        report.lost_area_share = if thickened { 0.0 } else { lost };
        report.contact_faces = surface.contact_faces;
        report.surface_triangles = surface.triangles.len();
    }

    fn inside(&self, closed: &[&Shell], open: &[&Shell]) -> Inside {
        let faces = |shells: &[&Shell]| -> Vec<[DVec3; 3]> {
            let all = shells.iter().flat_map(|s| &s.faces);
            all.map(|&f| self.corners(&self.soup.faces[f as usize])).collect()
        };
        Inside::new(&faces(closed), &faces(open), &self.rim(open))
    }

    /// The rims of open shells, less what cancels.
    fn rim(&self, open: &[&Shell]) -> Vec<([DVec3; 2], u32)> {
        let mut net: BTreeMap<[u32; 2], i64> = BTreeMap::new();
        for &([a, b], n) in open.iter().flat_map(|s| &s.rim) {
            let sign = if a < b { 1 } else { -1 };
            *net.entry([a.min(b), a.max(b)]).or_default() += sign * i64::from(n);
        }
        net.into_iter()
            .filter(|&(_, n)| n != 0)
            .map(|(ends, n)| (ends.map(|v| self.at(v)), n.unsigned_abs() as u32))
            .collect()
    }

    /// Those of the open shells that enclose something but for holes.
    fn holed<'s>(&self, open: &[&'s Shell]) -> Vec<&'s Shell> {
        let inside = self.inside(&[], open);
        let solid = |shell: &&&Shell| {
            let step = shell.faces.len().div_ceil(PROBES);
            let (mut yes, mut all) = (0.0, 0.0);
            for &f in shell.faces.iter().step_by(step) {
                let face = &self.soup.faces[f as usize];
                let [a, b, c] = self.corners(face);
                let off = (b - a).cross(c - a).normalize_or_zero() * self.scale.offset;
                let middle = (a + b + c) / 3.0;
                let [behind, front, ..] = inside.open_numbers(&[middle - off, middle + off]);
                let size = self.area(face);
                all += size;
                yes += if behind >= SOLID && front <= 1.0 - SOLID { size } else { 0.0 };
            }
            yes >= 0.5 * all
        };
        open.iter().filter(solid).copied().collect()
    }

    /// The faces to be thickened: not those doubled ones that lie inside a solid.
    fn sheets(&self, inside: &Inside) -> Vec<[DVec3; 3]> {
        let Some(Thicken { which, .. }) = self.options.thicken else {
            return vec![];
        };
        let chosen = |s: &&Shell| which == Which::All || !s.rim.is_empty();
        let shells = self.shells.iter().filter(chosen).flat_map(|s| &s.faces);
        let mut out: Vec<_> = shells.map(|&f| self.corners(&self.soup.faces[f as usize])).collect();
        let buried = |t: &[DVec3; 3]| {
            let [a, b, c] = *t;
            let off = (b - a).cross(c - a).normalize_or_zero() * self.scale.offset;
            let middle = (a + b + c) / 3.0;
            inside.at(middle + off) && inside.at(middle - off)
        };
        let double = self.soup.double.iter().map(|f| self.corners(f));
        out.extend(double.filter(|t| !buried(t)));
        out
    }
}
