// The functions of incise.h, and the handles that free their objects.

using System;
using System.Runtime.InteropServices;
using System.Text;
using Microsoft.Win32.SafeHandles;

namespace Incise
{
    /// <summary>The result of a call; the numbers of incise.h.</summary>
    public enum Status
    {
        Ok = 0,
        NullPointer = 1,
        InvalidHandle = 2,
        BufferTooSmall = 3,
        InvalidArgument = 4,
        OutOfRange = 5,
        InvalidMesh = 6,
        File = 7,
        Refused = 8,
        Simulation = 9,
        Panic = 10,
    }

    /// <summary>A failed call with the text of the library.</summary>
    public sealed class InciseException : Exception
    {
        /// <summary>The kind of failure.</summary>
        public Status Status { get; private set; }

        internal InciseException(Status status, string text) : base(text)
        {
            Status = status;
        }
    }

    /// <summary>The versions of the library.</summary>
    public static class Library
    {
        /// <summary>The version of incise.h for which this assembly was written.</summary>
        public const uint AbiVersion = 1;

        /// <summary>Returns the version of the native library, such as 0.1.0.</summary>
        public static string Version
        {
            get { return Marshal.PtrToStringAnsi(Native.incise_version()); }
        }

        /// <summary>Returns the number of native objects that are not freed yet.</summary>
        public static int LiveHandles
        {
            get { return (int)Native.incise_live_handles(); }
        }
    }

    internal sealed class MeshHandle : SafeHandleZeroOrMinusOneIsInvalid
    {
        public MeshHandle() : base(true) { }

        protected override bool ReleaseHandle()
        {
            return Native.incise_mesh_free(handle) == Status.Ok;
        }
    }

    internal sealed class CutHandle : SafeHandleZeroOrMinusOneIsInvalid
    {
        public CutHandle() : base(true) { }

        protected override bool ReleaseHandle()
        {
            return Native.incise_cut_result_free(handle) == Status.Ok;
        }
    }

    internal sealed class SceneHandle : SafeHandleZeroOrMinusOneIsInvalid
    {
        public SceneHandle() : base(true) { }

        protected override bool ReleaseHandle()
        {
            return Native.incise_scene_free(handle) == Status.Ok;
        }
    }

    /// <summary>P/Invoke. Arrays of blittable elements are pinned, not copied.</summary>
    internal static class Native
    {
        internal const string Dll = "incise_c";

        static Native()
        {
            uint version = incise_abi_version();
            if (version != Library.AbiVersion)
            {
                throw new DllNotFoundException(
                    "The native library incise_c has interface version " + version + ", this " +
                    "assembly needs " + Library.AbiVersion + ". Build both from one commit.");
            }
        }

        /// <summary>Throws the library's error unless the call succeeded.</summary>
        internal static void Check(Status status)
        {
            if (status != Status.Ok)
            {
                throw new InciseException(status, Text(incise_last_error()));
            }
        }

        static string Text(IntPtr text)
        {
            int length = 0;
            while (Marshal.ReadByte(text, length) != 0) length++;
            var bytes = new byte[length];
            Marshal.Copy(text, bytes, 0, length);
            return Encoding.UTF8.GetString(bytes);
        }

        /// <summary>Returns a text as UTF-8 with a final zero.</summary>
        internal static byte[] Utf8(string text)
        {
            if (text == null) throw new ArgumentNullException("text");
            return Encoding.UTF8.GetBytes(text + "\0");
        }

        internal static UIntPtr Size(Array array)
        {
            return array == null ? UIntPtr.Zero : (UIntPtr)(ulong)array.Length;
        }

        /// <summary>Returns the number of rows of a flat array.</summary>
        internal static UIntPtr Rows(Array array, int width, string name)
        {
            return array == null ? UIntPtr.Zero : Rows(array.Length, width, name);
        }

        internal static UIntPtr Rows(int length, int width, string name)
        {
            if (length % width != 0)
            {
                throw new ArgumentException(length + " numbers are no rows of " + width, name);
            }
            return (UIntPtr)(ulong)(length / width);
        }

        internal delegate Status TextCall(byte[] text, UIntPtr capacity, out UIntPtr length);

        /// <summary>Asks for the length of a text, then for the text.</summary>
        internal static string GetText(TextCall call)
        {
            UIntPtr length;
            Check(call(null, UIntPtr.Zero, out length));
            var bytes = new byte[(int)length + 1];
            Check(call(bytes, Size(bytes), out length));
            return Encoding.UTF8.GetString(bytes, 0, (int)length);
        }

        [DllImport(Dll)] internal static extern IntPtr incise_last_error();
        [DllImport(Dll)] internal static extern uint incise_abi_version();
        [DllImport(Dll)] internal static extern IntPtr incise_version();
        [DllImport(Dll)] internal static extern UIntPtr incise_live_handles();

        [DllImport(Dll)] internal static extern Status incise_mesh_new(
            float[] vertices, UIntPtr vertexCount, int[] faces, UIntPtr faceCount, float[] uv,
            UIntPtr uvCount, out MeshHandle mesh);
        [DllImport(Dll)] internal static extern Status incise_mesh_repair(
            float[] vertices, UIntPtr vertexCount, int[] faces, UIntPtr faceCount, float[] uv,
            UIntPtr uvCount, out MeshHandle mesh);
        [DllImport(Dll)] internal static extern Status incise_mesh_model(
            byte[] name, out MeshHandle mesh);
        [DllImport(Dll)] internal static extern Status incise_mesh_read(
            byte[] path, out MeshHandle mesh);
        [DllImport(Dll)] internal static extern Status incise_mesh_write(
            MeshHandle mesh, byte[] path);
        [DllImport(Dll)] internal static extern Status incise_mesh_free(IntPtr mesh);
        [DllImport(Dll)] internal static extern Status incise_mesh_count(
            MeshHandle mesh, out MeshCounts counts);
        [DllImport(Dll)] internal static extern Status incise_mesh_measure(
            MeshHandle mesh, out MeshMeasures measures);
        [DllImport(Dll)] internal static extern Status incise_mesh_vertices(
            MeshHandle mesh, [Out] float[] buffer, UIntPtr capacity);
        [DllImport(Dll)] internal static extern Status incise_mesh_faces(
            MeshHandle mesh, [Out] int[] buffer, UIntPtr capacity);
        [DllImport(Dll)] internal static extern Status incise_mesh_uv(
            MeshHandle mesh, [Out] float[] buffer, UIntPtr capacity);
        [DllImport(Dll)] internal static extern Status incise_mesh_warnings(
            MeshHandle mesh, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Dll)] internal static extern Status incise_mesh_fill(
            MeshHandle mesh, ref FillParams parameters, out FillReport report);
        [DllImport(Dll)] internal static extern Status incise_check(
            float[] vertices, UIntPtr vertexCount, int[] faces, UIntPtr faceCount,
            out MeshReport report, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Dll)] internal static extern Status incise_check_file(
            byte[] path, out MeshReport report, [Out] byte[] text, UIntPtr capacity,
            out UIntPtr length);
        [DllImport(Dll)] internal static extern Status incise_fill_params_init(
            out FillParams parameters);

        [DllImport(Dll)] internal static extern Status incise_cut_params_init(
            out CutParams parameters);
        [DllImport(Dll)] internal static extern Status incise_mesh_cut_plane(
            MeshHandle mesh, double[] normal, double d, ref CutParams parameters,
            out CutHandle result);
        [DllImport(Dll)] internal static extern Status incise_mesh_cut_path(
            MeshHandle mesh, float[] poses, UIntPtr poseCount, UIntPtr pointCount,
            ref CutParams parameters, out CutHandle result);
        [DllImport(Dll)] internal static extern Status incise_cut_result_free(IntPtr result);
        [DllImport(Dll)] internal static extern Status incise_cut_result_report(
            CutHandle result, out CutReport report);
        [DllImport(Dll)] internal static extern Status incise_cut_result_statistic(
            CutHandle result, byte[] name, out double value);
        [DllImport(Dll)] internal static extern Status incise_cut_result_mesh(
            CutHandle result, out MeshHandle mesh);
        [DllImport(Dll)] internal static extern Status incise_cut_result_piece(
            CutHandle result, uint index, out MeshHandle mesh);
        [DllImport(Dll)] internal static extern Status incise_cut_result_face_pieces(
            CutHandle result, [Out] int[] buffer, UIntPtr capacity);
        [DllImport(Dll)] internal static extern Status incise_cut_result_caps(
            CutHandle result, [Out] byte[] buffer, UIntPtr capacity);
        [DllImport(Dll)] internal static extern Status incise_cut_result_vertex_ids(
            CutHandle result, [Out] int[] buffer, UIntPtr capacity);
        [DllImport(Dll)] internal static extern Status incise_cut_result_origins(
            CutHandle result, [Out] int[] parents, UIntPtr parentCapacity, [Out] float[] weights,
            UIntPtr weightCapacity);

        [DllImport(Dll)] internal static extern Status incise_scene_params_init(
            out SceneParams parameters);
        [DllImport(Dll)] internal static extern Status incise_material_init(
            uint preset, out Material material);
        [DllImport(Dll)] internal static extern Status incise_scene_new(
            ref SceneParams parameters, out SceneHandle scene);
        [DllImport(Dll)] internal static extern Status incise_scene_free(IntPtr scene);
        [DllImport(Dll)] internal static extern Status incise_scene_set_params(
            SceneHandle scene, ref SceneParams parameters);
        [DllImport(Dll)] internal static extern Status incise_scene_set(
            SceneHandle scene, byte[] name, byte[] value);
        [DllImport(Dll)] internal static extern Status incise_scene_set_number(
            SceneHandle scene, byte[] name, double value);
        [DllImport(Dll)] internal static extern Status incise_scene_get(
            SceneHandle scene, byte[] name, [Out] byte[] text, UIntPtr capacity,
            out UIntPtr length);
        [DllImport(Dll)] internal static extern Status incise_scene_get_number(
            SceneHandle scene, byte[] name, out double value);
        [DllImport(Dll)] internal static extern Status incise_body_set(
            SceneHandle scene, uint body, byte[] name, byte[] value);
        [DllImport(Dll)] internal static extern Status incise_body_set_number(
            SceneHandle scene, uint body, byte[] name, double value);
        [DllImport(Dll)] internal static extern Status incise_body_get(
            SceneHandle scene, uint body, byte[] name, [Out] byte[] text, UIntPtr capacity,
            out UIntPtr length);
        [DllImport(Dll)] internal static extern Status incise_body_get_number(
            SceneHandle scene, uint body, byte[] name, out double value);
        [DllImport(Dll)] internal static extern Status incise_scene_save(
            SceneHandle scene, [Out] byte[] bytes, UIntPtr capacity, out UIntPtr length);
        [DllImport(Dll)] internal static extern Status incise_scene_load(
            byte[] bytes, UIntPtr length, out SceneHandle scene);
        [DllImport(Dll)] internal static extern Status incise_scene_set_colliders(
            SceneHandle scene, Collider[] colliders, UIntPtr count);
        [DllImport(Dll)] internal static extern Status incise_scene_origin(
            SceneHandle scene, [Out] double[] origin);
        [DllImport(Dll)] internal static extern Status incise_scene_add_blade(
            SceneHandle scene, float[] edge, out uint blade);
        [DllImport(Dll)] internal static extern Status incise_scene_move_blade(
            SceneHandle scene, uint blade, float[] edge);
        [DllImport(Dll)] internal static extern Status incise_scene_teleport_blade(
            SceneHandle scene, uint blade, float[] edge);
        [DllImport(Dll)] internal static extern Status incise_scene_incision(
            SceneHandle scene, uint blade, uint body, out Incision incision);
        [DllImport(Dll)] internal static extern Status incise_scene_set_blade_face(
            SceneHandle scene, uint blade, float[] face);
        [DllImport(Dll)] internal static extern Status incise_scene_step(
            SceneHandle scene, out FrameStats stats);
        [DllImport(Dll)] internal static extern Status incise_scene_statistic(
            SceneHandle scene, byte[] name, out double value);
        [DllImport(Dll)] internal static extern Status incise_scene_failed_cuts(
            SceneHandle scene, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Dll)] internal static extern Status incise_scene_undo(
            SceneHandle scene, uint body);
        [DllImport(Dll)] internal static extern Status incise_scene_undo_count(
            SceneHandle scene, uint body, out uint count);

        [DllImport(Dll)] internal static extern Status incise_scene_add_body(
            SceneHandle scene, MeshHandle mesh, ref Material material, out uint body);
        [DllImport(Dll)] internal static extern Status incise_scene_remove_body(
            SceneHandle scene, uint body);
        [DllImport(Dll)] internal static extern Status incise_body_set_material(
            SceneHandle scene, uint body, ref Material material);
        [DllImport(Dll)] internal static extern Status incise_body_count(
            SceneHandle scene, uint body, out BodyCounts counts);
        [DllImport(Dll)] internal static extern Status incise_body_positions(
            SceneHandle scene, uint body, [Out] float[] buffer, UIntPtr capacity);
        [DllImport(Dll)] internal static extern Status incise_body_faces(
            SceneHandle scene, uint body, [Out] int[] buffer, UIntPtr capacity);
        [DllImport(Dll)] internal static extern Status incise_body_uv(
            SceneHandle scene, uint body, [Out] float[] buffer, UIntPtr capacity);
        [DllImport(Dll)] internal static extern Status incise_body_face_pieces(
            SceneHandle scene, uint body, [Out] int[] buffer, UIntPtr capacity);
        [DllImport(Dll)] internal static extern Status incise_body_face_materials(
            SceneHandle scene, uint body, [Out] int[] buffer, UIntPtr capacity);
        [DllImport(Dll)] internal static extern Status incise_body_mesh(
            SceneHandle scene, uint body, out MeshHandle mesh);
        [DllImport(Dll)] internal static extern Status incise_body_pin(
            SceneHandle scene, uint body, uint vertex);
        [DllImport(Dll)] internal static extern Status incise_body_unpin(
            SceneHandle scene, uint body, uint vertex);
        [DllImport(Dll)] internal static extern Status incise_body_move_pin(
            SceneHandle scene, uint body, uint vertex, float[] position);
        [DllImport(Dll)] internal static extern Status incise_body_cast_ray(
            SceneHandle scene, uint body, double[] origin, double[] direction, out RayHit hit);
    }
}
