// Parameters and reports, laid out as the structs of incise.h, whose comments describe the fields.

using System.Runtime.InteropServices;

namespace Incise
{
    /// <summary>The curves of a cut that are closed by caps.</summary>
    public enum Caps : uint
    {
        /// <summary>Those of closed bodies.</summary>
        Bodies = 0,
        /// <summary>Those of bodies, and closed curves in sheets.</summary>
        AllLoops = 1,
        /// <summary>None.</summary>
        None = 2,
    }

    /// <summary>Parameters of a cut. Start with <see cref="Default"/>.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct CutParams
    {
        public Caps Caps;
        public uint CapMaterial;
        /// <summary>Texture coordinates of caps per meter.</summary>
        public double CapUvScale;
        /// <summary>Edge length of caps relative to the surface: 2, 1.5, 1, 1/1.5, 0.5.</summary>
        public double Level;
        public double Grading;
        public double Snap;
        public double Remesh;

        /// <summary>Returns the defaults of the library.</summary>
        public static CutParams Default
        {
            get
            {
                CutParams parameters;
                Native.Check(Native.incise_cut_params_init(out parameters));
                return parameters;
            }
        }
    }

    /// <summary>Parameters of <see cref="Surface.Fill"/>.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct FillParams
    {
        public double Level;
        public uint MaxRimEdges;
        public uint MaxTriangles;

        /// <summary>Returns the defaults of the library.</summary>
        public static FillParams Default
        {
            get
            {
                FillParams parameters;
                Native.Check(Native.incise_fill_params_init(out parameters));
                return parameters;
            }
        }
    }

    /// <summary>Report of <see cref="Surface.Fill"/>.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct FillReport
    {
        public uint Filled, LeftOpen, NewFaces, SelfIntersecting;
    }

    /// <summary>Counts of a surface.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct MeshCounts
    {
        public uint Vertices, Faces, Uv, Pieces, BoundaryEdges;
    }

    /// <summary>Measures of a surface in meters.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct MeshMeasures
    {
        public double Area, Volume, MeanEdge;
        public float LowX, LowY, LowZ, HighX, HighY, HighZ;
        public double OriginX, OriginY, OriginZ;
    }

    /// <summary>Properties of a mesh that may not be cuttable.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct MeshReport
    {
        /// <summary>1 or 0.</summary>
        public uint Cuttable, Closed, Manifold, Oriented;
        public uint Vertices, Faces, Components, OpenEdges, NonmanifoldEdges, NonmanifoldVertices;
        public uint WindingConflicts, DegenerateFaces;
        public double Area, Volume;
    }

    /// <summary>Counts of a cut.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct CutReport
    {
        public uint Pieces, Vertices, Faces, CapFaces, InputVertices, CreatedVertices;
        public uint Steps, Hits, Loops, Slits, TipVertices;
        public double MovedVolume, MovedSurface, Seconds;
    }

    /// <summary>Parameters of a scene. Start with <see cref="Default"/>.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct SceneParams
    {
        public float Dt;
        public float GravityX, GravityY, GravityZ;
        /// <summary>Length of a substep in seconds; 0 for one per frame.</summary>
        public float Substep;
        public uint Iterations, Threads;
        /// <summary>1 for contacts between bodies, pieces and blades.</summary>
        public uint Contacts;
        public float ContactThickness;
        public uint SelfCollision, Sleep;
        /// <summary>1 if blades may stop inside bodies.</summary>
        public uint Progressive;
        public uint UndoLimit;
        /// <summary>0: the CPU; 1: a GPU; 2: the faster one.</summary>
        public uint Backend;
        public CutParams Cut;

        /// <summary>Returns the defaults of the library.</summary>
        public static SceneParams Default
        {
            get
            {
                SceneParams parameters;
                Native.Check(Native.incise_scene_params_init(out parameters));
                return parameters;
            }
        }
    }

    /// <summary>Kinds of stiffness.</summary>
    public enum StiffnessKind : uint
    {
        None = 0,
        /// <summary>0 to 1, of position based dynamics.</summary>
        Pbd = 1,
        /// <summary>Inverse stiffness of XPBD.</summary>
        Compliance = 2,
    }

    /// <summary>Material of a body. Start with one of the properties.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Material
    {
        /// <summary>0: kg/m^2; 1: kg/m^3.</summary>
        public uint DensityKind;
        public float Density;
        public StiffnessKind StretchKind;
        public float Stretch;
        public StiffnessKind BendingKind;
        public float Bending;
        public uint HasVolume;
        public float Compressibility, Pressure;
        public StiffnessKind SpringKind;
        public float Spring, SpringDensity;
        /// <summary>1 for a solid, whose elasticity replaces stretch, bending, volume and springs.</summary>
        public uint HasSolid;
        public float YoungModulus, PoissonRatio, RelaxationTime;
        /// <summary>0: a third of the thickness of the body.</summary>
        public float CellSize;
        public uint CellsAcross;
        public float Damping, Friction;

        /// <summary>Returns a solid as heavy as water, 100 kPa.</summary>
        public static Material SoftBody { get { return Preset(0); } }

        /// <summary>Returns a stiff shell that keeps its curvature.</summary>
        public static Material Shell { get { return Preset(1); } }

        /// <summary>Returns cloth that does not stretch and bends freely.</summary>
        public static Material Cloth { get { return Preset(2); } }

        /// <summary>Returns a stiff shell that bends freely.</summary>
        public static Material LimpShell { get { return Preset(3); } }

        /// <summary>Returns human skin, 420 kPa.</summary>
        public static Material Skin { get { return Preset(4); } }

        /// <summary>Returns a healthy human liver, 5.4 kPa.</summary>
        public static Material Liver { get { return Preset(5); } }

        /// <summary>Returns relaxed skeletal muscle, 12 kPa.</summary>
        public static Material Muscle { get { return Preset(6); } }

        /// <summary>Returns gelatin of 5 %, 12.5 kPa.</summary>
        public static Material Jelly { get { return Preset(7); } }

        /// <summary>Returns natural rubber, 2,000 kPa.</summary>
        public static Material Rubber { get { return Preset(8); } }

        static Material Preset(uint preset)
        {
            Material material;
            Native.Check(Native.incise_material_init(preset, out material));
            return material;
        }
    }

    /// <summary>Kinds of colliders.</summary>
    public enum ColliderKind : uint
    {
        Plane = 0,
        Sphere = 1,
        Capsule = 2,
        Box = 3,
    }

    /// <summary>A rigid obstacle. Fields that its kind does not need are ignored.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Collider
    {
        public ColliderKind Kind;
        public float Radius;
        public float PositionX, PositionY, PositionZ;
        public float DirectionX, DirectionY, DirectionZ;
        public float EndX, EndY, EndZ;
        public float HalfX, HalfY, HalfZ;
        public float Axis0X, Axis0Y, Axis0Z, Axis1X, Axis1Y, Axis1Z;

        /// <summary>Returns the half-space below a height.</summary>
        public static Collider Ground(float height)
        {
            return new Collider {
                Kind = ColliderKind.Plane, PositionY = height, DirectionY = 1 };
        }
    }

    /// <summary>Counters and times of a frame.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct FrameStats
    {
        public uint Sweeps, MissedSweeps, Cuts, FailedCuts, Contacts, SleepingBodies;
        public double CutSeconds, ContactSeconds, SolverSeconds;
    }

    /// <summary>Where a blade is after its last step in a body.</summary>
    public enum IncisionState : uint
    {
        /// <summary>Outside, and it has cut nothing since it was inside.</summary>
        Outside = 0,
        /// <summary>At the tip of its cut, or moved back along its path, even out.</summary>
        Inside = 1,
        /// <summary>Ahead of the tip, because the last step was refused.</summary>
        Blocked = 2,
        /// <summary>Outside, and its cut is complete.</summary>
        Finished = 3,
        /// <summary>Outside, and the tip of its cut is in the body.</summary>
        Abandoned = 4,
    }

    /// <summary>The incision of a blade in a body.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Incision
    {
        public IncisionState State;
        /// <summary>Number of refused steps since the last one that cut.</summary>
        public uint RefusedSteps;
    }

    /// <summary>Counts of a body.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct BodyCounts
    {
        public uint Vertices, Faces, Uv, Pieces, Asleep;
        /// <summary>Changes when the triangles change, and only then.</summary>
        public ulong Version;
    }

    /// <summary>The first hit of a ray.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct RayHit
    {
        /// <summary>1 if the ray hits.</summary>
        public uint Hit;
        /// <summary>The nearest corner of the triangle.</summary>
        public uint Vertex;
        public double Distance;
    }
}
