using System;

namespace Incise
{
    /// <summary>A triangle surface: a body or a sheet that can be cut.</summary>
    /// <remarks>Arrays are flat: 3 floats per vertex (meters), 3 indices per triangle.</remarks>
    public sealed partial class Surface : IDisposable
    {
        internal readonly MeshHandle Handle;

        internal Surface(MeshHandle handle)
        {
            Handle = handle;
        }

        /// <summary>Makes a surface that keeps the indices of its arrays.</summary>
        /// <param name="uv">None, 2 floats per vertex, or 2 floats per corner.</param>
        /// <exception cref="InciseException">The triangles form no oriented manifold.</exception>
        public static Surface FromArrays(float[] vertices, int[] faces, float[] uv = null)
        {
            MeshHandle mesh;
            Native.Check(Native.incise_mesh_new(
                vertices, Native.Rows(vertices, 3, "vertices"), faces,
                Native.Rows(faces, 3, "faces"), uv, Native.Rows(uv, 2, "uv"), out mesh));
            return new Surface(mesh);
        }

        /// <summary>Welds and repairs arrays, such as those of a renderer's mesh.</summary>
        /// <exception cref="InciseException">The mesh has no unique repair.</exception>
        public static Surface Repair(float[] vertices, int[] faces, float[] uv = null)
        {
            MeshHandle mesh;
            Native.Check(Native.incise_mesh_repair(
                vertices, Native.Rows(vertices, 3, "vertices"), faces,
                Native.Rows(faces, 3, "faces"), uv, Native.Rows(uv, 2, "uv"), out mesh));
            return new Surface(mesh);
        }

        /// <summary>Builds one of the paper's models, such as Bunny or Sphere768.</summary>
        public static Surface Model(string name)
        {
            MeshHandle mesh;
            Native.Check(Native.incise_mesh_model(Native.Utf8(name), out mesh));
            return new Surface(mesh);
        }

        /// <summary>Reads and repairs a file: obj, ply, stl, glb or gltf.</summary>
        public static Surface Read(string path)
        {
            MeshHandle mesh;
            Native.Check(Native.incise_mesh_read(Native.Utf8(path), out mesh));
            return new Surface(mesh);
        }

        /// <summary>Checks arrays of any quality. Repairs and defects get a line each.</summary>
        public static MeshReport Check(float[] vertices, int[] faces, out string text)
        {
            var report = new MeshReport();
            text = Native.GetText((byte[] bytes, UIntPtr capacity, out UIntPtr length) =>
                Native.incise_check(
                    vertices, Native.Rows(vertices, 3, "vertices"), faces,
                    Native.Rows(faces, 3, "faces"), out report, bytes, capacity, out length));
            return report;
        }

        /// <summary>Checks a file; otherwise as <see cref="Check"/>.</summary>
        public static MeshReport CheckFile(string path, out string text)
        {
            var report = new MeshReport();
            text = Native.GetText((byte[] bytes, UIntPtr capacity, out UIntPtr length) =>
                Native.incise_check_file(
                    Native.Utf8(path), out report, bytes, capacity, out length));
            return report;
        }

        /// <summary>Writes a file: obj, ply, stl or glb.</summary>
        public void Write(string path)
        {
            Native.Check(Native.incise_mesh_write(Handle, Native.Utf8(path)));
        }

        /// <summary>Returns the counts.</summary>
        public MeshCounts Counts
        {
            get
            {
                MeshCounts counts;
                Native.Check(Native.incise_mesh_count(Handle, out counts));
                return counts;
            }
        }

        /// <summary>Returns area, volume, mean edge and bounding box.</summary>
        public MeshMeasures Measures
        {
            get
            {
                MeshMeasures measures;
                Native.Check(Native.incise_mesh_measure(Handle, out measures));
                return measures;
            }
        }

        /// <summary>Returns the warnings of the reader, the repair or the last writer.</summary>
        public string Warnings
        {
            get
            {
                return Native.GetText((byte[] bytes, UIntPtr capacity, out UIntPtr length) =>
                    Native.incise_mesh_warnings(Handle, bytes, capacity, out length));
            }
        }

        /// <summary>Returns 3 floats per vertex.</summary>
        public float[] Vertices()
        {
            var buffer = new float[3 * Counts.Vertices];
            Native.Check(Native.incise_mesh_vertices(Handle, buffer, Native.Size(buffer)));
            return buffer;
        }

        /// <summary>Returns 3 indices per triangle.</summary>
        public int[] Faces()
        {
            var buffer = new int[3 * Counts.Faces];
            Native.Check(Native.incise_mesh_faces(Handle, buffer, Native.Size(buffer)));
            return buffer;
        }

        /// <summary>Returns 2 floats per corner, 3 corners per triangle; or none.</summary>
        public float[] Uv()
        {
            var buffer = new float[2 * Counts.Uv];
            Native.Check(Native.incise_mesh_uv(Handle, buffer, Native.Size(buffer)));
            return buffer;
        }

        /// <summary>Fills the holes.</summary>
        public FillReport Fill(FillParams? parameters = null)
        {
            FillParams fill = parameters ?? FillParams.Default;
            FillReport report;
            Native.Check(Native.incise_mesh_fill(Handle, ref fill, out report));
            return report;
        }

        /// <summary>Cuts a copy along the plane normal . x = d.</summary>
        /// <exception cref="InciseException">The cut was refused.</exception>
        public CutResult Cut(double[] normal, double d, CutParams? parameters = null)
        {
            RequireLength(normal, 3, "normal");
            CutParams cut = parameters ?? CutParams.Default;
            CutHandle result;
            Native.Check(Native.incise_mesh_cut_plane(Handle, normal, d, ref cut, out result));
            return new CutResult(result);
        }

        /// <summary>Cuts a copy by a blade that moves pose by pose, and may stop inside.</summary>
        /// <param name="poses">3 floats per point, all points of a pose, pose after pose.</param>
        /// <param name="points">Number of points of the blade's edge, at least 2.</param>
        public CutResult CutPath(float[] poses, int points, CutParams? parameters = null)
        {
            if (points < 2) throw new ArgumentOutOfRangeException("points", "pass at least 2");
            CutParams cut = parameters ?? CutParams.Default;
            CutHandle result;
            Native.Check(Native.incise_mesh_cut_path(
                Handle, poses, Native.Rows(poses, 3 * points, "poses"), (UIntPtr)(ulong)points,
                ref cut, out result));
            return new CutResult(result);
        }

        /// <summary>Frees the native mesh.</summary>
        public void Dispose()
        {
            Handle.Dispose();
        }

        internal static void RequireLength(Array array, int length, string name)
        {
            if (array == null) throw new ArgumentNullException(name);
            RequireLength(array.Length, length, name);
        }

        internal static void RequireLength(int found, int length, string name)
        {
            if (found != length)
            {
                throw new ArgumentException(found + " numbers, not " + length, name);
            }
        }
    }
}
