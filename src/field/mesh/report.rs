/// What was found in a mesh on the way to its field, for the user to see.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshReport {
    /// Faces of the mesh as given.
    pub faces: usize,
    /// Faces without area in the topology: two corners coincide.
    pub degenerate_faces: usize,
    /// Faces dropped because another has the same corners.
    pub duplicate_faces: usize,
    /// Shells: faces that hang together over edges.
    pub shells: usize,
    /// Shells with a rim.
    pub open_shells: usize,
    /// Shells that were inside out and have been turned.
    pub flipped_shells: usize,
    /// Faces turned to agree with their neighbours.
    pub flipped_faces: usize,
    /// Length of all rims, mm.
    pub rim_length: f64,
    /// Area of all faces, duplicates counted once, mm².
    pub area: f64,
    /// Share of the area in open shells.
    pub open_area_share: f64,
    /// Share of the area that lay there in both directions and encloses nothing.
    pub double_area_share: f64,
    /// Faces that lie, in part at least, inside the union of all shells.
    pub buried_faces: usize,
    /// Share of the area inside the union: no surface.
    pub buried_area_share: f64,
    /// Share of the area with outside on both sides that thickening does not restore.
    pub lost_area_share: f64,
    /// Faces that touch or cross others.
    pub contact_faces: usize,
    /// Triangles that the distance is measured to, cut pieces included.
    pub surface_triangles: usize,
    /// Faces that were thickened.
    pub thickened_faces: usize,
    /// Whether anything is inside by the winding number.
    pub solid: bool,
}

impl MeshReport {
    /// One line for each thing a user should know, most important first; none for a clean mesh.
    pub fn summary(&self) -> Vec<String> {
        let percent = |share: f64| format!("{:.1}%", share * 100.0);
        let mut lines = vec![];
        let mut say = |when: bool, line: String| {
            if when {
                lines.push(line);
            }
        };
        say(
            self.lost_area_share > 1e-3,
            format!(
                "{} of the area has no thickness and is lost; thicken keeps it",
                percent(self.lost_area_share)
            ),
        );
        say(
            self.open_shells > 0,
            format!(
                "{} of {} shells are open ({} of the area, {:.0} mm of rim)",
                self.open_shells,
                self.shells,
                percent(self.open_area_share),
                self.rim_length
            ),
        );
        say(self.thickened_faces > 0, format!("{} faces are thickened", self.thickened_faces));
        say(
            self.flipped_shells > 0,
            format!("{} of {} shells were inside out: turned", self.flipped_shells, self.shells),
        );
        say(
            self.flipped_faces > 0,
            format!("{} faces disagreed with their neighbours: turned", self.flipped_faces),
        );
        say(
            self.buried_area_share > 0.0,
            format!(
                "{} of the area is buried inside other shells: no surface",
                percent(self.buried_area_share)
            ),
        );
        say(
            self.duplicate_faces + self.degenerate_faces > 0,
            format!(
                "{} duplicate and {} degenerate faces dropped",
                self.duplicate_faces, self.degenerate_faces
            ),
        );
        lines
    }
}
