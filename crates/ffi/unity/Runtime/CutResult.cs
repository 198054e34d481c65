using System;

namespace Incise
{
    /// <summary>A cut copy of a surface with its caps, pieces and origins of vertices.</summary>
    public sealed class CutResult : IDisposable
    {
        readonly CutHandle handle;

        /// <summary>Counts and time of the cut.</summary>
        public CutReport Report { get; private set; }

        internal CutResult(CutHandle handle)
        {
            this.handle = handle;
            CutReport report;
            Native.Check(Native.incise_cut_result_report(handle, out report));
            Report = report;
        }

        /// <summary>Returns a count or a time, see <see cref="CutStatistic"/>.</summary>
        public double Statistic(string name)
        {
            double value;
            Native.Check(Native.incise_cut_result_statistic(
                handle, Native.Utf8(name), out value));
            return value;
        }

        /// <summary>Returns the cut surface with all pieces.</summary>
        public Surface Surface()
        {
            MeshHandle mesh;
            Native.Check(Native.incise_cut_result_mesh(handle, out mesh));
            return new Surface(mesh);
        }

        /// <summary>Returns one piece.</summary>
        public Surface Piece(int index)
        {
            MeshHandle mesh;
            Native.Check(Native.incise_cut_result_piece(handle, unchecked((uint)index), out mesh));
            return new Surface(mesh);
        }

        /// <summary>Returns the index of the piece of each triangle.</summary>
        public int[] FacePieces()
        {
            var buffer = new int[Report.Faces];
            Native.Check(Native.incise_cut_result_face_pieces(
                handle, buffer, Native.Size(buffer)));
            return buffer;
        }

        /// <summary>Returns 1 for each triangle of a cap or wall, else 0.</summary>
        public byte[] Caps()
        {
            var buffer = new byte[Report.Faces];
            Native.Check(Native.incise_cut_result_caps(handle, buffer, Native.Size(buffer)));
            return buffer;
        }

        /// <summary>Returns the id of each vertex: a vertex of the input, or InputVertices plus a
        /// row of <see cref="Origins"/>.</summary>
        public int[] VertexIds()
        {
            var buffer = new int[Report.Vertices];
            Native.Check(Native.incise_cut_result_vertex_ids(handle, buffer, Native.Size(buffer)));
            return buffer;
        }

        /// <summary>Returns ids of 3 parents and 3 weights of each created vertex.</summary>
        public void Origins(out int[] parents, out float[] weights)
        {
            parents = new int[3 * Report.CreatedVertices];
            weights = new float[3 * Report.CreatedVertices];
            Native.Check(Native.incise_cut_result_origins(
                handle, parents, Native.Size(parents), weights, Native.Size(weights)));
        }

        /// <summary>Frees the native result. Surfaces that were taken from it stay.</summary>
        public void Dispose()
        {
            handle.Dispose();
        }
    }
}
