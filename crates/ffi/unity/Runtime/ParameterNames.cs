// Made from the parameters of the library by its test `generated`.

namespace Incise
{
    /// <summary>Names of the parameters of a scene.</summary>
    public static class SceneParameter
    {
        /// <summary>Duration of a frame.</summary>
        public const string Dt = "dt";
        /// <summary>Symmetric iterations per substep, usually 1 to 10.</summary>
        public const string SolverIterations = "solver.iterations";
        /// <summary>Length of a substep; `None` is one substep per frame, as long as the frame.</summary>
        public const string SolverSubstep = "solver.substep";
        /// <summary>Share of the last internal displacement that the prediction of a substep repeats.</summary>
        public const string SolverLift = "solver.lift";
        /// <summary>Gravitational acceleration.</summary>
        public const string SolverGravity = "solver.gravity";
        /// <summary>Displacement per iteration and axis below which a substep ends its iterations early.</summary>
        public const string SolverResidual = "solver.residual";
        /// <summary>Over-relaxation of the XPBD diagonal of compliant constraints, 1/2 to 1; 1 is XPBD.</summary>
        public const string SolverDiagonalScale = "solver.diagonal_scale";
        /// <summary>Restores the momenta of pieces that touch nothing, and limits the energy of bodies.</summary>
        public const string SolverConserve = "solver.conserve";
        /// <summary>Enables long range attachments of inextensible, pinned bodies.</summary>
        public const string SolverAttachments = "solver.attachments";
        /// <summary>Time integration of a substep.</summary>
        public const string SolverIntegrator = "solver.integrator";
        /// <summary>Maximum number of threads of a step on the CPU; `None` for all of the current rayon pool.</summary>
        public const string SolverThreads = "solver.threads";
        /// <summary>Minimum length of edges along the rim.</summary>
        public const string CutSnap = "cut.snap";
        /// <summary>Maximum displacement of the old surface by remeshing.</summary>
        public const string CutRemesh = "cut.remesh";
        /// <summary>Edge length relative to the rim's edges.</summary>
        public const string CutRefineLevel = "cut.refine.level";
        /// <summary>Edge length of the surface at the rim: the t of the paper's Formula 2.</summary>
        public const string CutRefineRimLength = "cut.refine.rim_length";
        /// <summary>Growth of the target length with the distance from the rim.</summary>
        public const string CutRefineGrading = "cut.refine.grading";
        /// <summary>Maximum number of triangles of a patch; a patch that needs more is an error.</summary>
        public const string CutRefineMaxTriangles = "cut.refine.max_triangles";
        /// <summary>The curves along which caps and walls close the surface again.</summary>
        public const string CutCaps = "cut.caps";
        /// <summary>The material of caps and walls.</summary>
        public const string CutCapMaterial = "cut.cap_material";
        /// <summary>Texture coordinates of caps and walls per unit of length. They are positions in the sweep laid flat, times this number.</summary>
        public const string CutCapUvScale = "cut.cap_uv_scale";
        /// <summary>Cuts only this piece of the surface; the sweep passes through the others. A step of an incision may renumber the piece of its tip.</summary>
        public const string CutOnlyPiece = "cut.only_piece";
        /// <summary>Whether a sweep skips bodies whose bounding box it does not overlap.</summary>
        public const string SkipFarSweeps = "skip_far_sweeps";
        /// <summary>Interval of checkpoints of GPU bodies; 0 = none.</summary>
        public const string Checkpoint = "checkpoint";
        /// <summary>Contacts between bodies, their pieces and blade faces; `None` disables them.</summary>
        public const string Contacts = "contacts";
        /// <summary>Minimum distance between surfaces, relative to edges of the finer body.</summary>
        public const string ContactsThickness = "contacts.thickness";
        /// <summary>Whether the triangles of one piece collide with each other.</summary>
        public const string ContactsSelfCollision = "contacts.self_collision";
        /// <summary>When bodies at rest fall asleep; `None` steps every body in every frame.</summary>
        public const string Sleep = "sleep";
        /// <summary>Maximum speed of a vertex along an axis at rest.</summary>
        public const string SleepSpeed = "sleep.speed";
        /// <summary>Time for which every vertex must be slower.</summary>
        public const string SleepSeconds = "sleep.seconds";
    }

    /// <summary>Names of the parameters of a material.</summary>
    public static class MaterialParameter
    {
        /// <summary>Density, from which masses follow.</summary>
        public const string Density = "density";
        /// <summary>Stiffness of edges against a change of length.</summary>
        public const string Stretch = "stretch";
        /// <summary>Stiffness of interior edges against a change of angle. `None` has no arrays and no passes.</summary>
        public const string Bending = "bending";
        /// <summary>Resistance of closed pieces to a change of volume. `None` costs nothing.</summary>
        public const string Volume = "volume";
        /// <summary>Inverse bulk modulus; 0 is incompressible, water has 5e-10.</summary>
        public const string VolumeCompressibility = "volume.compressibility";
        /// <summary>Target volume over rest volume: 1 keeps it, 0 collapses, more than 1 inflates (Mueller et al. 2007, section 4.4).</summary>
        public const string VolumePressure = "volume.pressure";
        /// <summary>Springs through the body. `None` costs nothing.</summary>
        public const string InteriorSprings = "interior_springs";
        /// <summary>Fraction of vertices that have a spring of their own, 0 to 1.</summary>
        public const string InteriorSpringsDensity = "interior_springs.density";
        /// <summary>Stiffness of the springs.</summary>
        public const string InteriorSpringsStiffness = "interior_springs.stiffness";
        /// <summary>Elasticity of the inside of a closed body; `None` for a body that is only a surface.</summary>
        public const string Solid = "solid";
        /// <summary>Young's modulus.</summary>
        public const string SolidYoungModulus = "solid.young_modulus";
        /// <summary>Poisson's ratio, the share of a stretch by which a rod becomes thinner; near 1/2 the material keeps its volume.</summary>
        public const string SolidPoissonRatio = "solid.poisson_ratio";
        /// <summary>Relaxation time of the viscosity: stress grows by this time, Young's modulus and the rate of strain.</summary>
        public const string SolidRelaxationTime = "solid.relaxation_time";
        /// <summary>Length of the edges of a cell; `None` for a third of the thickness `2 V / A` of the body.</summary>
        public const string SolidCellSize = "solid.cell_size";
        /// <summary>Maximum number of cells along the longest side of the body, which enlarges cells.</summary>
        public const string SolidCellsAcross = "solid.cells_across";
        /// <summary>Decay rate of velocities relative to the rigid motion of a piece.</summary>
        public const string Damping = "damping";
        /// <summary>Coulomb friction coefficient against colliders and contacts.</summary>
        public const string Friction = "friction";
    }

    /// <summary>Names of the counts and times of a cut.</summary>
    public static class CutStatistic
    {
        /// <summary>Triangles whose bounding boxes touch the sweep.</summary>
        public const string Candidates = "candidates";
        /// <summary>Triangles that the sweep crosses.</summary>
        public const string Hits = "hits";
        /// <summary>Curves along which the sweep crosses the surface as a whole: closed ones and, in sheets, those from boundary to boundary.</summary>
        public const string Loops = "loops";
        /// <summary>Curves with an end where the sweep ends inside the body or the sheet: slits.</summary>
        public const string Slits = "slits";
        /// <summary>Vertices that snapping moved into the rim.</summary>
        public const string SnappedVertices = "snapped_vertices";
        /// <summary>Intersection points that snapping merged into others.</summary>
        public const string MergedPoints = "merged_points";
        /// <summary>Edges around the rim that remeshing flipped.</summary>
        public const string FlippedEdges = "flipped_edges";
        /// <summary>Vertices beside the rim that remeshing collapsed onto others.</summary>
        public const string CollapsedVertices = "collapsed_vertices";
        /// <summary>Intersection points that remeshing merged into others.</summary>
        public const string CollapsedPoints = "collapsed_points";
        /// <summary>Upper bound of the displacement of the surface by remeshing.</summary>
        public const string MovedSurface = "moved_surface";
        /// <summary>Volume moved by snapping and remeshing, without sign.</summary>
        public const string MovedVolume = "moved_volume";
        /// <summary>Rim edges left shorter than `CutParams::snap`, where a merge would change the topology or move too much volume.</summary>
        public const string ShortRimEdges = "short_rim_edges";
        /// <summary>Whether every cap reached its target edge length.</summary>
        public const string Refined = "refined";
        /// <summary>Time of the BVH query and of the intersection.</summary>
        public const string SecondsDetection = "seconds.detection";
        /// <summary>Time of opening the surface along the rim.</summary>
        public const string SecondsSplit = "seconds.split";
        /// <summary>Time of remeshing around the rim.</summary>
        public const string SecondsRemeshing = "seconds.remeshing";
        /// <summary>Time of meshing the caps.</summary>
        public const string SecondsCap = "seconds.cap";
        /// <summary>Time of refining the caps.</summary>
        public const string SecondsRefinement = "seconds.refinement";
        /// <summary>Time of numbering the pieces. Their search runs beside the caps of large bodies.</summary>
        public const string SecondsSeparation = "seconds.separation";
        /// <summary>Time of deriving the delta and the undo, and of checking the result near walls.</summary>
        public const string SecondsCommit = "seconds.commit";
        /// <summary>Time of updating the BVH; zero for a cutter that defers it.</summary>
        public const string SecondsBvhUpdate = "seconds.bvh_update";
        /// <summary>Sum of all times.</summary>
        public const string SecondsTotal = "seconds.total";
    }

    /// <summary>Names of the counters and times of a frame.</summary>
    public static class FrameStatistic
    {
        /// <summary>Blades that moved.</summary>
        public const string Sweeps = "sweeps";
        /// <summary>Sweeps that intersected no body.</summary>
        public const string MissedSweeps = "missed_sweeps";
        /// <summary>Blades that did not move, or only along their edge.</summary>
        public const string RestingBlades = "resting_blades";
        /// <summary>Body and sweep pairs whose bounding boxes overlapped, so that triangles were tested.</summary>
        public const string NarrowPhaseQueries = "narrow_phase_queries";
        /// <summary>Body and sweep pairs whose bounding boxes were disjoint.</summary>
        public const string BroadPhaseRejections = "broad_phase_rejections";
        /// <summary>Bodies whose bounding box was computed from all vertices.</summary>
        public const string AabbsComputed = "aabbs_computed";
        /// <summary>BVHs refitted to moved triangles.</summary>
        public const string BvhRefits = "bvh_refits";
        /// <summary>BVHs that needed no refit: no motion, or no query besides cuts.</summary>
        public const string BvhRefitsSkipped = "bvh_refits_skipped";
        /// <summary>Triangles returned by BVH queries of sweeps.</summary>
        public const string CandidateTriangles = "candidate_triangles";
        /// <summary>Triangles that sweeps intersected.</summary>
        public const string HitTriangles = "hit_triangles";
        /// <summary>Cuts done.</summary>
        public const string Cuts = "cuts";
        /// <summary>Cuts that failed, see `Scene::failed_cuts`.</summary>
        public const string FailedCuts = "failed_cuts";
        /// <summary>Body and collider pairs passed to the solver.</summary>
        public const string ColliderPairs = "collider_pairs";
        /// <summary>Contacts between pieces and with blade faces, see `SceneParams::contacts`.</summary>
        public const string Contacts = "contacts";
        /// <summary>Bodies searched for contacts.</summary>
        public const string ContactSearches = "contact_searches";
        /// <summary>Bodies that were asleep during the frame, see `SleepParams`.</summary>
        public const string SleepingBodies = "sleeping_bodies";
        /// <summary>Bodies that fell asleep at the end of the frame.</summary>
        public const string FellAsleep = "fell_asleep";
        /// <summary>Bodies that woke since the previous frame.</summary>
        public const string Woken = "woken";
        /// <summary>CPU solver iterations saved, see `incise_pbd_gpu::SolverParams::residual`.</summary>
        public const string IterationsSkipped = "iterations_skipped";
        /// <summary>Bodies that the GPU steps.</summary>
        public const string GpuBodies = "gpu_bodies";
        /// <summary>GPU bodies stepped by one workgroup each, see `incise_pbd_gpu::Schedule`.</summary>
        public const string WholeBodies = "whole_bodies";
        /// <summary>GPU bodies stepped pass by pass, with one workgroup per patch.</summary>
        public const string PatchBodies = "patch_bodies";
        /// <summary>GPU dispatches of the frame.</summary>
        public const string Dispatches = "dispatches";
        /// <summary>GPU kernels compiled since the previous frame.</summary>
        public const string KernelsCompiled = "kernels_compiled";
        /// <summary>GPU bodies read back because their bounding box overlapped a sweep's.</summary>
        public const string Readbacks = "readbacks";
        /// <summary>GPU bodies that no sweep came near.</summary>
        public const string ReadbacksSkipped = "readbacks_skipped";
        /// <summary>Bytes uploaded to the GPU since the previous frame: edits and parameters.</summary>
        public const string BytesUploaded = "bytes_uploaded";
        /// <summary>Bytes read back since the previous frame: states, bounding boxes, checkpoints.</summary>
        public const string BytesRead = "bytes_read";
        /// <summary>Whether the scene or a body moved from the GPU to the CPU since the previous frame.</summary>
        public const string FellBack = "fell_back";
        /// <summary>Time of BVH refits, queries and intersection tests.</summary>
        public const string SecondsDetection = "seconds.detection";
        /// <summary>Time of mesh edits.</summary>
        public const string SecondsTopology = "seconds.topology";
        /// <summary>Time of meshing cross-sections.</summary>
        public const string SecondsRefinement = "seconds.refinement";
        /// <summary>Time of updating constraints and BVHs after cuts.</summary>
        public const string SecondsConstraintUpdate = "seconds.constraint_update";
        /// <summary>Time of uploading edited bodies to the GPU.</summary>
        public const string SecondsGpuUpload = "seconds.gpu_upload";
        /// <summary>Time of finding contacts.</summary>
        public const string SecondsContactDetection = "seconds.contact_detection";
        /// <summary>Time of the CPU solver and of submitting GPU work.</summary>
        public const string SecondsSolver = "seconds.solver";
        /// <summary>Sum of all times.</summary>
        public const string SecondsTotal = "seconds.total";
    }
}
