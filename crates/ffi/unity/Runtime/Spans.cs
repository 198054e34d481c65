// Overloads with spans, which need no copy of a part of an array or of native memory.

#if NETSTANDARD2_1_OR_GREATER || NETCOREAPP2_1_OR_GREATER || UNITY_2021_2_OR_NEWER || INCISE_SPANS

using System;
using System.Runtime.InteropServices;

namespace Incise
{
    static class SpanNative
    {
        [DllImport(Native.Dll)] internal static extern Status incise_mesh_new(
            ref float vertices, UIntPtr vertexCount, ref int faces, UIntPtr faceCount,
            ref float uv, UIntPtr uvCount, out MeshHandle mesh);
        [DllImport(Native.Dll)] internal static extern Status incise_mesh_repair(
            ref float vertices, UIntPtr vertexCount, ref int faces, UIntPtr faceCount,
            ref float uv, UIntPtr uvCount, out MeshHandle mesh);
        [DllImport(Native.Dll)] internal static extern Status incise_scene_add_blade(
            SceneHandle scene, ref float edge, out uint blade);
        [DllImport(Native.Dll)] internal static extern Status incise_scene_move_blade(
            SceneHandle scene, uint blade, ref float edge);
        [DllImport(Native.Dll)] internal static extern Status incise_scene_teleport_blade(
            SceneHandle scene, uint blade, ref float edge);
        [DllImport(Native.Dll)] internal static extern Status incise_body_positions(
            SceneHandle scene, uint body, ref float buffer, UIntPtr capacity);
        [DllImport(Native.Dll)] internal static extern Status incise_body_faces(
            SceneHandle scene, uint body, ref int buffer, UIntPtr capacity);
        [DllImport(Native.Dll)] internal static extern Status incise_body_move_pin(
            SceneHandle scene, uint body, uint vertex, ref float position);

        /// <summary>Returns the first element, NULL for an empty span.</summary>
        internal static ref T First<T>(ReadOnlySpan<T> span)
        {
            return ref MemoryMarshal.GetReference(span);
        }

        internal static UIntPtr Size<T>(ReadOnlySpan<T> span)
        {
            return (UIntPtr)(ulong)span.Length;
        }

        internal static UIntPtr Rows<T>(ReadOnlySpan<T> span, int width, string name)
        {
            return Native.Rows(span.Length, width, name);
        }

        internal static ref float Fixed(ReadOnlySpan<float> span, int length, string name)
        {
            Surface.RequireLength(span.Length, length, name);
            return ref First(span);
        }
    }

    public sealed partial class Surface
    {
        /// <summary>Makes a surface that keeps the indices of its spans.</summary>
        /// <param name="uv">Empty, 2 floats per vertex, or 2 floats per corner.</param>
        /// <exception cref="InciseException">The triangles form no oriented manifold.</exception>
        public static Surface FromArrays(
            ReadOnlySpan<float> vertices, ReadOnlySpan<int> faces,
            ReadOnlySpan<float> uv = default(ReadOnlySpan<float>))
        {
            MeshHandle mesh;
            Native.Check(SpanNative.incise_mesh_new(
                ref SpanNative.First(vertices), SpanNative.Rows(vertices, 3, "vertices"),
                ref SpanNative.First(faces), SpanNative.Rows(faces, 3, "faces"),
                ref SpanNative.First(uv), SpanNative.Rows(uv, 2, "uv"), out mesh));
            return new Surface(mesh);
        }

        /// <summary>Welds and repairs spans, such as those of a renderer's mesh.</summary>
        /// <exception cref="InciseException">The mesh has no unique repair.</exception>
        public static Surface Repair(
            ReadOnlySpan<float> vertices, ReadOnlySpan<int> faces,
            ReadOnlySpan<float> uv = default(ReadOnlySpan<float>))
        {
            MeshHandle mesh;
            Native.Check(SpanNative.incise_mesh_repair(
                ref SpanNative.First(vertices), SpanNative.Rows(vertices, 3, "vertices"),
                ref SpanNative.First(faces), SpanNative.Rows(faces, 3, "faces"),
                ref SpanNative.First(uv), SpanNative.Rows(uv, 2, "uv"), out mesh));
            return new Surface(mesh);
        }
    }

    public sealed partial class Scene
    {
        /// <summary>Adds a blade with its edge from start to end: 6 floats.</summary>
        public uint AddBlade(ReadOnlySpan<float> edge)
        {
            uint blade;
            Native.Check(SpanNative.incise_scene_add_blade(
                handle, ref SpanNative.Fixed(edge, 6, "edge"), out blade));
            return blade;
        }

        /// <summary>Moves a blade; the next step cuts along its sweep.</summary>
        public void MoveBlade(uint blade, ReadOnlySpan<float> edge)
        {
            Native.Check(SpanNative.incise_scene_move_blade(
                handle, blade, ref SpanNative.Fixed(edge, 6, "edge")));
        }

        /// <summary>Moves a blade without cutting, and ends its incisions.</summary>
        public void TeleportBlade(uint blade, ReadOnlySpan<float> edge)
        {
            Native.Check(SpanNative.incise_scene_teleport_blade(
                handle, blade, ref SpanNative.Fixed(edge, 6, "edge")));
        }

        /// <summary>Copies 3 floats per vertex to a buffer of at least that length.</summary>
        public void CopyPositions(uint body, Span<float> buffer)
        {
            Native.Check(SpanNative.incise_body_positions(
                handle, body, ref SpanNative.First<float>(buffer),
                SpanNative.Size<float>(buffer)));
        }

        /// <summary>Copies 3 indices per triangle.</summary>
        public void CopyFaces(uint body, Span<int> buffer)
        {
            Native.Check(SpanNative.incise_body_faces(
                handle, body, ref SpanNative.First<int>(buffer), SpanNative.Size<int>(buffer)));
        }

        /// <summary>Sets where a pinned vertex is at the end of the next frame: 3 floats.</summary>
        public void MovePin(uint body, uint vertex, ReadOnlySpan<float> position)
        {
            Native.Check(SpanNative.incise_body_move_pin(
                handle, body, vertex, ref SpanNative.Fixed(position, 3, "position")));
        }
    }
}

#endif
