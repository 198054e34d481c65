using System;

namespace Incise
{
    /// <summary>Bodies and blades, stepped frame by frame.</summary>
    /// <remarks>Bodies and blades are named by the indices that their Add methods return.</remarks>
    public sealed partial class Scene : IDisposable
    {
        readonly SceneHandle handle;

        /// <summary>Makes an empty scene.</summary>
        public Scene(SceneParams? parameters = null)
        {
            SceneParams scene = parameters ?? SceneParams.Default;
            Native.Check(Native.incise_scene_new(ref scene, out handle));
        }

        Scene(SceneHandle handle)
        {
            this.handle = handle;
        }

        /// <summary>Makes a scene of the bytes of Save. It goes on with the same bits.</summary>
        public static Scene Load(byte[] bytes)
        {
            SceneHandle scene;
            Native.Check(Native.incise_scene_load(bytes, Native.Size(bytes), out scene));
            return new Scene(scene);
        }

        /// <summary>Returns the scene as bytes, without the undoable cuts.</summary>
        public byte[] Save()
        {
            UIntPtr length;
            Native.Check(Native.incise_scene_save(handle, null, UIntPtr.Zero, out length));
            var bytes = new byte[(int)length];
            Native.Check(Native.incise_scene_save(handle, bytes, length, out length));
            return bytes;
        }

        /// <summary>Sets the parameters from the next frame on.</summary>
        public void SetParams(SceneParams parameters)
        {
            Native.Check(Native.incise_scene_set_params(handle, ref parameters));
        }

        /// <summary>Replaces all colliders.</summary>
        public void SetColliders(Collider[] colliders)
        {
            Native.Check(Native.incise_scene_set_colliders(
                handle, colliders, Native.Size(colliders)));
        }

        /// <summary>Returns the point to which all coordinates are relative: 3 numbers.</summary>
        public double[] Origin
        {
            get
            {
                var origin = new double[3];
                Native.Check(Native.incise_scene_origin(handle, origin));
                return origin;
            }
        }

        /// <summary>Adds a copy of a surface as a body at rest; a soft body by default.</summary>
        public uint AddBody(Surface surface, Material? material = null)
        {
            if (surface == null) throw new ArgumentNullException("surface");
            // Mono keeps its reference to the first handle of a call whose second one is refused.
            if (surface.Handle.IsClosed) throw new ObjectDisposedException("surface");
            Material of = material ?? Material.SoftBody;
            uint body;
            Native.Check(Native.incise_scene_add_body(handle, surface.Handle, ref of, out body));
            return body;
        }

        /// <summary>Removes a body.</summary>
        public void RemoveBody(uint body)
        {
            Native.Check(Native.incise_scene_remove_body(handle, body));
        }

        /// <summary>Changes the numbers of a body's material from the next frame on.</summary>
        /// <remarks>The density stays, and bending and springs do not come or go.</remarks>
        public void SetMaterial(uint body, Material material)
        {
            Native.Check(Native.incise_body_set_material(handle, body, ref material));
        }

        /// <summary>Adds a blade with its edge from start to end: 6 floats.</summary>
        public uint AddBlade(float[] edge)
        {
            Surface.RequireLength(edge, 6, "edge");
            uint blade;
            Native.Check(Native.incise_scene_add_blade(handle, edge, out blade));
            return blade;
        }

        /// <summary>Moves a blade; the next step cuts along its sweep.</summary>
        public void MoveBlade(uint blade, float[] edge)
        {
            Surface.RequireLength(edge, 6, "edge");
            Native.Check(Native.incise_scene_move_blade(handle, blade, edge));
        }

        /// <summary>Moves a blade without cutting, and ends its incisions.</summary>
        public void TeleportBlade(uint blade, float[] edge)
        {
            Surface.RequireLength(edge, 6, "edge");
            Native.Check(Native.incise_scene_teleport_blade(handle, blade, edge));
        }

        /// <summary>Returns whether a blade is inside a body, and its refused steps.</summary>
        public Incision Incision(uint blade, uint body)
        {
            Incision incision;
            Native.Check(Native.incise_scene_incision(handle, blade, body, out incision));
            return incision;
        }

        /// <summary>Gives a blade a face, the vector from edge to back; null removes it.</summary>
        public void SetBladeFace(uint blade, float[] face)
        {
            if (face != null) Surface.RequireLength(face, 3, "face");
            Native.Check(Native.incise_scene_set_blade_face(handle, blade, face));
        }

        /// <summary>Steps by one frame: cuts, then moves the bodies.</summary>
        public FrameStats Step()
        {
            FrameStats stats;
            Native.Check(Native.incise_scene_step(handle, out stats));
            return stats;
        }

        /// <summary>Returns a counter or a time of the last frame, see
        /// <see cref="FrameStatistic"/>.</summary>
        public double Statistic(string name)
        {
            double value;
            Native.Check(Native.incise_scene_statistic(handle, Native.Utf8(name), out value));
            return value;
        }

        /// <summary>Returns a line for each cut that was refused in the last frame.</summary>
        public string FailedCuts
        {
            get
            {
                return Native.GetText((byte[] bytes, UIntPtr capacity, out UIntPtr length) =>
                    Native.incise_scene_failed_cuts(handle, bytes, capacity, out length));
            }
        }

        /// <summary>Undoes the last cut of a body, and ends the incisions in it.</summary>
        public void Undo(uint body)
        {
            Native.Check(Native.incise_scene_undo(handle, body));
        }

        /// <summary>Returns the number of cuts of a body that can be undone.</summary>
        public uint UndoCount(uint body)
        {
            uint count;
            Native.Check(Native.incise_scene_undo_count(handle, body, out count));
            return count;
        }

        /// <summary>Returns the counts of a body.</summary>
        public BodyCounts Counts(uint body)
        {
            BodyCounts counts;
            Native.Check(Native.incise_body_count(handle, body, out counts));
            return counts;
        }

        /// <summary>Copies 3 floats per vertex to a buffer of at least that length.</summary>
        public void CopyPositions(uint body, float[] buffer)
        {
            Native.Check(Native.incise_body_positions(handle, body, buffer, Native.Size(buffer)));
        }

        /// <summary>Copies 3 indices per triangle.</summary>
        public void CopyFaces(uint body, int[] buffer)
        {
            Native.Check(Native.incise_body_faces(handle, body, buffer, Native.Size(buffer)));
        }

        /// <summary>Copies 2 floats per corner.</summary>
        public void CopyUv(uint body, float[] buffer)
        {
            Native.Check(Native.incise_body_uv(handle, body, buffer, Native.Size(buffer)));
        }

        /// <summary>Copies the piece number of each triangle.</summary>
        public void CopyFacePieces(uint body, int[] buffer)
        {
            Native.Check(Native.incise_body_face_pieces(
                handle, body, buffer, Native.Size(buffer)));
        }

        /// <summary>Copies the material number of each triangle: CapMaterial for caps.</summary>
        public void CopyFaceMaterials(uint body, int[] buffer)
        {
            Native.Check(Native.incise_body_face_materials(
                handle, body, buffer, Native.Size(buffer)));
        }

        /// <summary>Returns a body as a surface in its present shape.</summary>
        public Surface ToSurface(uint body)
        {
            MeshHandle mesh;
            Native.Check(Native.incise_body_mesh(handle, body, out mesh));
            return new Surface(mesh);
        }

        /// <summary>Pins a vertex where it is.</summary>
        public void Pin(uint body, uint vertex)
        {
            Native.Check(Native.incise_body_pin(handle, body, vertex));
        }

        /// <summary>Releases a pinned vertex.</summary>
        public void Unpin(uint body, uint vertex)
        {
            Native.Check(Native.incise_body_unpin(handle, body, vertex));
        }

        /// <summary>Sets where a pinned vertex is at the end of the next frame: 3 floats.</summary>
        public void MovePin(uint body, uint vertex, float[] position)
        {
            Surface.RequireLength(position, 3, "position");
            Native.Check(Native.incise_body_move_pin(handle, body, vertex, position));
        }

        /// <summary>Returns the first hit of a ray at a body in its present shape.</summary>
        public RayHit CastRay(uint body, double[] origin, double[] direction)
        {
            Surface.RequireLength(origin, 3, "origin");
            Surface.RequireLength(direction, 3, "direction");
            RayHit hit;
            Native.Check(Native.incise_body_cast_ray(handle, body, origin, direction, out hit));
            return hit;
        }

        /// <summary>Frees the native scene.</summary>
        public void Dispose()
        {
            handle.Dispose();
        }
    }
}
