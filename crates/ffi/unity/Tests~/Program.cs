// Tests of the assembly under Mono: errors and a scene, or the cuts of the list at a path.

using System;
using Incise;

static class Program
{
    static int failures;

    static void Expect(bool isTrue, string text)
    {
        if (isTrue) return;
        failures++;
        Console.WriteLine("failed: " + text);
    }

    static void ExpectError(Status status, string word, Action call)
    {
        try
        {
            call();
            Expect(false, "no error: " + word);
        }
        catch (InciseException error)
        {
            bool isExpected = error.Status == status && error.Message.Contains(word);
            Expect(isExpected, status + " with '" + word + "', not " + error.Status + ": "
                + error.Message);
        }
    }

    static void Throws<T>(Action call) where T : Exception
    {
        try
        {
            call();
            Expect(false, "no " + typeof(T).Name);
        }
        catch (T) { }
    }

    static readonly float[] Corners = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
    static readonly int[] Sides = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };

    static void Errors()
    {
        ExpectError(Status.OutOfRange, "faces[0] is 9",
            () => Surface.FromArrays(Corners, new[] { 9, 0, 1 }));
        ExpectError(Status.OutOfRange, "faces[2] is 4294967295",
            () => Surface.FromArrays(Corners, new[] { 0, 1, -1 }));
        var nan = (float[])Corners.Clone();
        nan[4] = float.NaN;
        ExpectError(Status.InvalidArgument, "vertices[4]", () => Surface.FromArrays(nan, Sides));
        ExpectError(Status.InvalidArgument, "uv has 3",
            () => Surface.FromArrays(Corners, Sides, new float[6]));
        ExpectError(Status.InvalidArgument, "Bunny", () => Surface.Model("Hühnchen"));
        ExpectError(Status.File, "kein-Häschen.obj", () => Surface.Read("kein-Häschen.obj"));
        Throws<ArgumentException>(() => Surface.FromArrays(new float[4], Sides));
        Throws<ArgumentNullException>(() => Surface.Model(null));
        using (Surface surface = Surface.FromArrays(Corners, Sides))
        {
            Expect(Math.Abs(surface.Measures.Volume - 1 / 6.0) < 1e-7, "volume");
            Expect(surface.Measures.HighZ == 1, "bounding box");
            ExpectError(Status.Refused, "no area", () => surface.Cut(new double[3], 0));
            ExpectError(Status.InvalidArgument, "finite",
                () => surface.Cut(new[] { 0, double.NaN, 0 }, 0));
            Throws<ArgumentException>(() => surface.Cut(new double[2], 0));
            ExpectError(Status.InvalidArgument, "2 of each",
                () => surface.CutPath(new float[6], 2));
            using (CutResult result = surface.Cut(new[] { 0, 1, 0.2 }, 0.3))
            {
                Expect(result.Report.Pieces == 2, "two pieces");
                ExpectError(Status.OutOfRange, "piece 2", () => result.Piece(2));
                CheckOrigins(result);
            }
        }
        var disposed = Surface.FromArrays(Corners, Sides);
        disposed.Dispose();
        Throws<ObjectDisposedException>(() => disposed.Cut(new[] { 0, 1, 0.2 }, 0.3));
        disposed.Dispose();
        using (var scene = new Scene())
        {
            Throws<ObjectDisposedException>(() => scene.AddBody(disposed));
            Throws<ArgumentNullException>(() => scene.AddBody(null));
        }
        Expect(Library.LiveHandles == 0, "a scene that refused a body is disposed of");
        string text;
        var open = new[] { 0, 2, 1, 0, 1, 3, 0, 3, 2 };
        MeshReport report = Surface.Check(Corners, open, out text);
        Expect(report.OpenEdges == 3 && report.Closed == 0, "check: " + text);
        using (Surface surface = Surface.Repair(Corners, open))
        {
            Expect(surface.Counts.BoundaryEdges == 3, "a boundary");
            Expect(surface.Fill().Filled == 1 && surface.Counts.BoundaryEdges == 0, "filled");
        }
    }

    /// <summary>Interpolates positions by ids and origins. Nothing was snapped.</summary>
    static void CheckOrigins(CutResult result)
    {
        int[] parents;
        float[] weights;
        result.Origins(out parents, out weights);
        int input = (int)result.Report.InputVertices;
        var at = new float[3 * input + parents.Length];
        Array.Copy(Corners, at, Corners.Length);
        for (int row = 0; row < parents.Length / 3; row++)
        {
            for (int k = 0; k < 9; k++)
            {
                int parent = parents[3 * row + k / 3];
                Expect(parent < input + row, "parents come first");
                at[3 * (input + row) + k % 3] += weights[3 * row + k / 3] * at[3 * parent + k % 3];
            }
        }
        using (Surface surface = result.Surface())
        {
            float[] vertices = surface.Vertices();
            int[] ids = result.VertexIds();
            for (int k = 0; k < vertices.Length; k++)
            {
                float error = Math.Abs(vertices[k] - at[3 * ids[k / 3] + k % 3]);
                Expect(error < 1e-5, "origin of vertex " + k / 3);
            }
        }
    }

    static void SceneIsSteppedAndCut()
    {
        SceneParams parameters = SceneParams.Default;
        Expect(parameters.GravityY == -9.81f && parameters.Cut.Level == 1, "layout of params");
        parameters.Contacts = 1;
        using (var scene = new Scene(parameters))
        using (Surface bunny = Surface.Model("Bunny"))
        {
            scene.SetColliders(new[] { Collider.Ground(-0.6f) });
            uint body = scene.AddBody(bunny);
            var edge = new float[] { -1, 0.05f, -1, -1, 0.05f, 1 };
            uint blade = scene.AddBlade(edge);
            scene.Step();
            BodyCounts before = scene.Counts(body);
            edge[0] = edge[3] = 1;
            scene.MoveBlade(blade, edge);
            FrameStats stats = scene.Step();
            BodyCounts after = scene.Counts(body);
            Expect(stats.Cuts == 1 && after.Pieces == 2, "a cut: " + scene.FailedCuts);
            Expect(after.Version != before.Version, "another version");
            var positions = new float[3 * after.Vertices];
            for (int frame = 0; frame < 60; frame++) scene.Step();
            scene.CopyPositions(body, positions);
            float low = float.MaxValue;
            for (int k = 1; k < positions.Length; k += 3) low = Math.Min(low, positions[k]);
            Expect(low > -0.61f && low < -0.5f, "it fell to the ground: " + low);
            var materials = new int[after.Faces];
            scene.CopyFaceMaterials(body, materials);
            Expect(Array.IndexOf(materials, 1) >= 0, "caps have a material");
            RayHit hit = scene.CastRay(body, new double[] { 0, 9, 0 }, new double[] { 0, -1, 0 });
            Expect(hit.Hit == 1 && hit.Distance > 8, "a ray from above");
            scene.Pin(body, hit.Vertex);
            scene.MovePin(body, hit.Vertex, new float[] { 0, 1, 0 });
            scene.Step();
            scene.CopyPositions(body, positions);
            Expect(positions[3 * hit.Vertex + 1] == 1, "a dragged pin");
            scene.Unpin(body, hit.Vertex);
            Expect(scene.UndoCount(body) == 1, "one cut to undo");
            scene.Undo(body);
            Expect(scene.Counts(body).Version == before.Version, "the version before the cut");
            ExpectError(Status.Refused, "no cut", () => scene.Undo(body));
            ExpectError(Status.BufferTooSmall, "needs",
                () => scene.CopyPositions(body, new float[3]));
            ExpectError(Status.OutOfRange, "blade 3", () => scene.MoveBlade(3, edge));
            edge[4] = float.NaN;
            ExpectError(Status.InvalidArgument, "edge[4]", () => scene.MoveBlade(blade, edge));
            SceneParams bad = parameters;
            bad.Dt = float.NaN;
            ExpectError(Status.InvalidArgument, "dt is NaN", () => scene.SetParams(bad));
            Material slippery = Material.SoftBody;
            slippery.Friction = 0;
            scene.SetMaterial(body, slippery);
            slippery.Friction = float.NaN;
            ExpectError(Status.Simulation, "friction", () => scene.SetMaterial(body, slippery));
            using (Scene loaded = Scene.Load(scene.Save()))
            {
                scene.Step();
                loaded.Step();
                var others = new float[3 * loaded.Counts(body).Vertices];
                positions = new float[others.Length];
                scene.CopyPositions(body, positions);
                loaded.CopyPositions(body, others);
                bool isSame = true;
                for (int k = 0; k < others.Length; k++) isSame &= positions[k] == others[k];
                Expect(isSame, "a loaded scene goes on with the same bits");
            }
            ExpectError(Status.File, "", () => Scene.Load(new byte[9]));
            double[] origin = scene.Origin;
            Expect(origin[0] == 0 && origin[1] == 0 && origin[2] == 0, "an origin near zero");
            foreach (float radius in new[] { float.NaN, -1 })
            {
                var ball = new Collider { Kind = ColliderKind.Sphere, Radius = radius };
                ExpectError(Status.InvalidArgument, "collider 0",
                    () => scene.SetColliders(new[] { ball }));
            }
            scene.SetColliders(new[] {
                new Collider { Kind = ColliderKind.Sphere, Radius = 0.1f, PositionY = -5 },
                new Collider { Kind = ColliderKind.Box, HalfX = 1, HalfY = 1, HalfZ = 1,
                    PositionX = 9, Axis0X = 1, Axis1Y = 1 } });
            scene.Step();
        }
    }

    static void IncisionsHaveStates()
    {
        SceneParams parameters = SceneParams.Default;
        parameters.GravityY = 0;
        using (var scene = new Scene(parameters))
        using (Surface ball = Surface.Model("Sphere768"))
        {
            uint body = scene.AddBody(ball);
            uint blade = scene.AddBlade(new float[] { -2, 0, -2, -2, 0, 2 });
            Expect(scene.Incision(blade, body).State == IncisionState.Outside, "no incision");
            MoveTo(scene, blade, body, 0, 0, IncisionState.Inside);
            MoveTo(scene, blade, body, 2, 0, IncisionState.Finished);
            scene.TeleportBlade(blade, new float[] { -2, 0.2f, -2, -2, 0.2f, 2 });
            Expect(scene.Incision(blade, body).State == IncisionState.Outside, "a teleport");
            MoveTo(scene, blade, body, 0, 0.2f, IncisionState.Inside);
            MoveTo(scene, blade, body, -1.5f, 1.2f, IncisionState.Abandoned);
            ExpectError(Status.OutOfRange, "blade 3", () => scene.Incision(3, body));
            ExpectError(Status.OutOfRange, "body 3", () => scene.Incision(blade, 3));
        }
    }

    static void MoveTo(
        Scene scene, uint blade, uint body, float x, float y, IncisionState state)
    {
        scene.MoveBlade(blade, new[] { x, y, -2, x, y, 2 });
        scene.Step();
        Incision incision = scene.Incision(blade, body);
        Expect(incision.State == state && incision.RefusedSteps == 0,
            incision.State + " is not " + state);
    }

#if INCISE_SPANS
    static void SpansAreArrays()
    {
        var padded = new float[Corners.Length + 5];
        Array.Copy(Corners, 0, padded, 2, Corners.Length);
        var corners = new ReadOnlySpan<float>(padded, 2, Corners.Length);
        using (Surface surface = Surface.FromArrays(corners, new ReadOnlySpan<int>(Sides)))
        using (Surface repaired = Surface.Repair(corners, new ReadOnlySpan<int>(Sides)))
        using (var scene = new Scene())
        {
            Expect(surface.Measures.Volume == repaired.Measures.Volume, "volumes of spans");
            uint body = scene.AddBody(surface);
            var edge = new float[] { 0, -9, 0, 0, -9, 0, 1, 0 };
            uint blade = scene.AddBlade(new ReadOnlySpan<float>(edge, 1, 6));
            scene.MoveBlade(blade, new ReadOnlySpan<float>(edge, 1, 6));
            scene.TeleportBlade(blade, new ReadOnlySpan<float>(edge, 2, 6));
            Throws<ArgumentException>(() =>
                scene.MoveBlade(blade, new ReadOnlySpan<float>(edge, 0, 5)));
            scene.Pin(body, 1);
            scene.MovePin(body, 1, new ReadOnlySpan<float>(new float[] { 2, 0, 0 }));
            scene.Step();
            var copy = new float[12];
            scene.CopyPositions(body, copy);
            var buffer = new float[20];
            scene.CopyPositions(body, new Span<float>(buffer, 4, 12));
            for (int k = 0; k < 12; k++) Expect(buffer[4 + k] == copy[k], "position " + k);
            Expect(copy[3] == 2 && buffer[3] == 0 && buffer[16] == 0, "within the span");
            var faces = new int[12];
            scene.CopyFaces(body, new Span<int>(faces));
            Expect(faces[11] == Sides[11], "faces of spans");
            ExpectError(Status.BufferTooSmall, "needs",
                () => scene.CopyPositions(body, new Span<float>(buffer, 0, 11)));
            ExpectError(Status.NullPointer, "out",
                () => scene.CopyPositions(body, Span<float>.Empty));
        }
        Throws<ArgumentException>(() =>
            Surface.FromArrays(
                new ReadOnlySpan<float>(Corners, 0, 4), new ReadOnlySpan<int>(Sides)));
    }
#endif

    static int Main(string[] arguments)
    {
        if (arguments.Length > 0)
        {
            Bits.Run(arguments[0]);
            return 0;
        }
        Errors();
        SceneIsSteppedAndCut();
        IncisionsHaveStates();
#if INCISE_SPANS
        SpansAreArrays();
#endif
        Expect(Library.LiveHandles == 0, "every object was disposed of");
        Console.WriteLine("incise {0}: {1} failures", Library.Version, failures);
        return failures == 0 ? 0 : 1;
    }
}
