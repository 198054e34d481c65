// Made from the parameters of the library by its test `generated`.

namespace Incise
{
    /// <summary>Names of the parameters of a scene.</summary>
    public static class SceneParameter
    {
        /// <summary>Duration of a frame.</summary>
        public const string Dt = "dt";
        /// <summary>Projections of every constraint per substep, usually 1 to 20.</summary>
        public const string SolverIterations = "solver.iterations";
        /// <summary>Minimum substeps per frame, usually 1 to 20. They stiffen a body more than as many iterations.</summary>
        public const string SolverSubsteps = "solver.substeps";
        /// <summary>Gravitational acceleration.</summary>
        public const string SolverGravity = "solver.gravity";
        /// <summary>Displacement per iteration and axis below which a substep ends its iterations early.</summary>
        public const string SolverResidual = "solver.residual";
        /// <summary>Over-relaxation of the XPBD diagonal of compliant constraints, 1/2 to 1; 1 is XPBD.</summary>
        public const string SolverDiagonalScale = "solver.diagonal_scale";
        /// <summary>Enables long range attachments of inextensible, pinned bodies.</summary>
        public const string SolverAttachments = "solver.attachments";
        /// <summary>Solution of the constraints of a substep.</summary>
        public const string SolverScheme = "solver.scheme";
        /// <summary>Time integration of a substep.</summary>
        public const string SolverIntegrator = "solver.integrator";
        /// <summary>Maximum number of threads of a step on the CPU; `None` for all of the current rayon pool.</summary>
        public const string SolverThreads = "solver.threads";
        /// <summary>The method that opens the surface, with its own parameters.</summary>
        public const string CutMethod = "cut.method";
        /// <summary>Minimum length of edges along the rim.</summary>
        public const string CutMethodExactSnap = "cut.method.exact.snap";
        /// <summary>Maximum displacement of the old surface by remeshing.</summary>
        public const string CutMethodExactRemesh = "cut.method.exact.remesh";
        /// <summary>Distance below which intersection points merge: the alpha of Algorithm 2, line 24.</summary>
        public const string CutMethodPaperMinDistance = "cut.method.paper.min_distance";
        /// <summary>Distance from the plane below which an edge of the old boundary stays: the beta of Algorithm 3. The paper gives no number.</summary>
        public const string CutMethodPaperBeta = "cut.method.paper.beta";
        /// <summary>Angle below which an ear of the new boundary is closed: Algorithm 3, line 31. The paper's value is 120.</summary>
        public const string CutMethodPaperEarAngle = "cut.method.paper.ear_angle";
        /// <summary>The algorithm for caps of the exact cutting method. `crate::paper::fill` ignores it.</summary>
        public const string CutRefineMethod = "cut.refine.method";
        /// <summary>Edge length relative to the rim's edges.</summary>
        public const string CutRefineLevel = "cut.refine.level";
        /// <summary>The t of Formula 2 for the whole patch.</summary>
        public const string CutRefineRimLength = "cut.refine.rim_length";
        /// <summary>Growth of the target length with the distance from the rim.</summary>
        public const string CutRefineGrading = "cut.refine.grading";
        /// <summary>Maximum rounds of subdivision and edge swaps: n of Algorithm 4.</summary>
        public const string CutRefineMaxRounds = "cut.refine.max_rounds";
        /// <summary>Maximum number of triangles of a patch; a patch that needs more is an error.</summary>
        public const string CutRefineMaxTriangles = "cut.refine.max_triangles";
        /// <summary>The curves along which the exact method closes the surface again.</summary>
        public const string CutCaps = "cut.caps";
        /// <summary>The material of caps and walls.</summary>
        public const string CutCapMaterial = "cut.cap_material";
        /// <summary>Texture coordinates of the exact method's caps and walls per unit of length. They are positions in the sweep laid flat, times this number.</summary>
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
        /// <summary>Rate at which velocities decay; bodies rebound less with it.</summary>
        public const string Damping = "damping";
        /// <summary>Coulomb friction coefficient against colliders and contacts.</summary>
        public const string Friction = "friction";
    }
}
