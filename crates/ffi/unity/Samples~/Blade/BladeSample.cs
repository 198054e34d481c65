// A body on the ground that the mouse cuts: hold the left button to hold a blade, drag to cut,
// press U to undo. Add the component to an empty object at the origin of a scene with a camera.

using System.Collections.Generic;
using Incise;
using UnityEngine;
using Scene = Incise.Scene;

[RequireComponent(typeof(MeshFilter), typeof(MeshRenderer))]
public sealed class BladeSample : MonoBehaviour
{
    [Tooltip("A built-in model, such as Bunny or Sphere768; or the path of a mesh file.")]
    public string model = "Bunny";

    [Tooltip("Height of the ground in meters.")]
    public float ground = -0.6f;

    [Tooltip("Materials of the skin and of the caps.")]
    public UnityEngine.Material skin, cap;

    Scene scene;
    uint body, blade;
    ulong version;
    Mesh mesh;
    float[] positions = new float[0];
    Vector3[] vertices = new Vector3[0];
    readonly float[] edge = new float[6];

    void OnEnable()
    {
        SceneParams parameters = SceneParams.Default;
        parameters.Dt = Time.fixedDeltaTime;
        parameters.Contacts = 1;
        scene = new Scene(parameters);
        scene.SetColliders(new[] { Collider.Ground(ground) });
        using (Surface surface = System.IO.File.Exists(model)
            ? Surface.Read(model) : Surface.Model(model))
        {
            body = scene.AddBody(surface);
        }
        blade = scene.AddBlade(edge);
        mesh = new Mesh { indexFormat = UnityEngine.Rendering.IndexFormat.UInt32 };
        mesh.MarkDynamic();
        version = 0;
        GetComponent<MeshFilter>().sharedMesh = mesh;
        GetComponent<MeshRenderer>().sharedMaterials = new[] { skin, cap };
    }

    void OnDisable()
    {
        scene.Dispose();
        Destroy(mesh);
    }

    // Edges of buttons are events of rendered frames; the blade itself moves with the physics.
    void Update()
    {
        if (Input.GetMouseButtonDown(0))
        {
            AimBlade();
            scene.TeleportBlade(blade, edge);
        }
        if (Input.GetKeyDown(KeyCode.U) && scene.UndoCount(body) > 0) scene.Undo(body);
    }

    void FixedUpdate()
    {
        if (Input.GetMouseButton(0))
        {
            AimBlade();
            scene.MoveBlade(blade, edge);
        }
        FrameStats stats = scene.Step();
        if (stats.FailedCuts > 0) Debug.LogWarning(scene.FailedCuts);
        Show();
    }

    /// <summary>Lays the blade's edge along the ray from the camera through the mouse.</summary>
    void AimBlade()
    {
        Camera camera = Camera.main;
        Ray ray = camera.ScreenPointToRay(Input.mousePosition);
        Vector3 from = ray.GetPoint(camera.nearClipPlane);
        Vector3 to = ray.GetPoint(camera.nearClipPlane + 10);
        for (int k = 0; k < 3; k++)
        {
            edge[k] = from[k];
            edge[3 + k] = to[k];
        }
    }

    /// <summary>Copies positions to the mesh, and triangles if a cut has changed them.</summary>
    void Show()
    {
        BodyCounts counts = scene.Counts(body);
        if (positions.Length != 3 * counts.Vertices)
        {
            positions = new float[3 * counts.Vertices];
            vertices = new Vector3[counts.Vertices];
        }
        scene.CopyPositions(body, positions);
        for (int i = 0; i < vertices.Length; i++)
        {
            vertices[i] = new Vector3(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]);
        }
        if (version != counts.Version)
        {
            version = counts.Version;
            mesh.Clear();
            mesh.vertices = vertices;
            var faces = new int[3 * counts.Faces];
            var materials = new int[counts.Faces];
            scene.CopyFaces(body, faces);
            scene.CopyFaceMaterials(body, materials);
            var parts = new[] { new List<int>(), new List<int>() };
            for (int t = 0; t < materials.Length; t++)
            {
                List<int> part = parts[materials[t] == 0 ? 0 : 1];
                for (int k = 0; k < 3; k++) part.Add(faces[3 * t + k]);
            }
            mesh.subMeshCount = 2;
            mesh.SetTriangles(parts[0], 0);
            mesh.SetTriangles(parts[1], 1);
        }
        else
        {
            mesh.vertices = vertices;
        }
        mesh.RecalculateNormals();
        mesh.RecalculateBounds();
    }
}
