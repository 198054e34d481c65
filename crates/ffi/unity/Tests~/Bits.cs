// Prints a line for each of 100 seeded cuts, like examples/cut_bits.rs, for a comparison.

using System;
using Incise;

static class Bits
{
    static ulong state = 20261125;

    /// <summary>Returns a number from -1 to 1 with 24 bits.</summary>
    static double Draw()
    {
        state = unchecked(state * 6364136223846793005 + 1);
        return (double)(state >> 40) / 8388608.0 - 1.0;
    }

    /// <summary>The hash FNV-1a.</summary>
    static ulong Hash(ulong value, Array words)
    {
        var bytes = new byte[Buffer.ByteLength(words)];
        Buffer.BlockCopy(words, 0, bytes, 0, bytes.Length);
        foreach (byte b in bytes) value = unchecked((value ^ b) * 0x100000001b3);
        return value;
    }

    static void Print(int i, CutResult result)
    {
        using (Surface surface = result.Surface())
        {
            ulong value = 0xcbf29ce484222325;
            value = Hash(value, surface.Vertices());
            value = Hash(value, surface.Faces());
            value = Hash(value, surface.Uv());
            value = Hash(value, result.FacePieces());
            value = Hash(value, Array.ConvertAll(result.Caps(), cap => (int)cap));
            Console.WriteLine(
                "{0} {1} {2} {3:x16}", i, result.Report.Pieces, result.Report.Hits, value);
        }
    }

    static CutResult Cut(Surface surface, int i, CutParams parameters)
    {
        if (i % 10 == 9)
        {
            double x = 0.1 * Draw(), z = 0.1 * Draw(), depth = 0.2 * Draw();
            var poses = new float[18];
            var heights = new[] { 0.7, 0.2, depth };
            for (int k = 0; k < 3; k++)
            {
                var pose = new[] { x, heights[k], z - 1, x, heights[k], z + 1 };
                for (int j = 0; j < 6; j++) poses[6 * k + j] = (float)pose[j];
            }
            return surface.CutPath(poses, 2, parameters);
        }
        var normal = new[] { Draw(), Draw(), Draw() };
        return surface.Cut(normal, 0.2 * Draw(), parameters);
    }

    internal static void Run()
    {
        var levels = new[] { 2, 1.5, 1, 1 / 1.5, 0.5 };
        using (Surface model = Surface.Model("Bunny"))
        using (Surface surface = Surface.FromArrays(model.Vertices(), model.Faces(), model.Uv()))
        {
            for (int i = 0; i < 100; i++)
            {
                CutParams parameters = CutParams.Default;
                parameters.Level = levels[i % 5];
                bool isPaper = i % 4 == 3 && i % 10 != 9;
                parameters.Method = isPaper ? CutMethod.Paper : CutMethod.Exact;
                try
                {
                    using (CutResult result = Cut(surface, i, parameters)) Print(i, result);
                }
                catch (InciseException error)
                {
                    if (error.Status != Status.Refused) throw;
                    Console.WriteLine("{0} refused", i);
                }
            }
        }
    }
}
