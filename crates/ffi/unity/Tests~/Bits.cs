// Prints the list of cuts at the path given (tests/seeded_cuts.txt) with its own results.

using System;
using System.Globalization;
using System.IO;
using Incise;

static class Bits
{
    /// <summary>Returns the CRC-32 of words that follow those of `crc`.</summary>
    static uint Crc32(uint crc, Array words)
    {
        var bytes = new byte[Buffer.ByteLength(words)];
        Buffer.BlockCopy(words, 0, bytes, 0, bytes.Length);
        crc = ~crc;
        foreach (byte b in bytes)
        {
            crc ^= b;
            for (int i = 0; i < 8; i++) crc = (crc & 1) == 1 ? (crc >> 1) ^ 0xedb88320 : crc >> 1;
        }
        return ~crc;
    }

    static uint Hash(uint crc, Surface surface)
    {
        return Crc32(Crc32(crc, surface.Vertices()), surface.Faces());
    }

    /// <summary>Returns the number of pieces and their hash.</summary>
    static string PiecesAndHash(CutResult result)
    {
        uint crc = 0;
        for (int i = 0; i < result.Report.Pieces; i++)
        {
            using (Surface piece = result.Piece(i)) crc = Hash(crc, piece);
        }
        return result.Report.Pieces + " " + crc.ToString("x8");
    }

    static CutResult Cut(Surface surface, string method, string level, double[] numbers)
    {
        CutParams parameters = CutParams.Default;
        if (level == "2x-finer") parameters.Level = 0.5;
        double x = numbers[0], y = numbers[1], z = numbers[2], d = numbers[3];
        if (method != "path") return surface.Cut(new[] { x, y, z }, d, parameters);
        var heights = new[] { y, 0.5 * (y + d), d };
        var poses = new float[18];
        for (int k = 0; k < 3; k++)
        {
            var pose = new[] { x, heights[k], z - 1, x, heights[k], z + 1 };
            for (int j = 0; j < 6; j++) poses[6 * k + j] = (float)pose[j];
        }
        return surface.CutPath(poses, 2, parameters);
    }

    /// <summary>Returns pieces and hash of a body that falls on a floor and is cut in frames 10
    /// and 11.</summary>
    static string Fall(Surface surface, double[] numbers)
    {
        float x = (float)numbers[0], y = (float)numbers[1], z = (float)numbers[2];
        SceneParams parameters = SceneParams.Default;
        parameters.Contacts = parameters.Threads = 1;
        using (var scene = new Scene(parameters))
        {
            scene.SetColliders(new[] { Collider.Ground((float)numbers[3]) });
            uint body = scene.AddBody(surface);
            var edge = new[] { -x, y, -z, -x, y, z };
            uint blade = scene.AddBlade(edge);
            for (int frame = 0; frame < 90; frame++)
            {
                if (frame == 10 || frame == 11)
                {
                    edge[0] = edge[3] = frame == 10 ? 0 : x;
                    scene.MoveBlade(blade, edge);
                }
                scene.Step();
            }
            using (Surface end = scene.ToSurface(body))
                return end.Counts.Pieces + " " + Hash(0, end).ToString("x8");
        }
    }

    static string Result(Surface surface, string method, string level, double[] numbers)
    {
        if (method == "scene") return Fall(surface, numbers);
        try
        {
            using (CutResult cut = Cut(surface, method, level, numbers)) return PiecesAndHash(cut);
        }
        catch (InciseException error) when (error.Status == Status.Refused)
        {
            return "refused";
        }
    }

    internal static void Run(string path)
    {
        foreach (string line in File.ReadAllLines(path))
        {
            string[] words = line.Split(' ');
            var numbers = new double[4];
            for (int i = 0; i < 4; i++)
                numbers[i] = double.Parse(words[3 + i], CultureInfo.InvariantCulture);
            using (Surface model = Surface.Model(words[0]))
            using (Surface surface = Surface.FromArrays(model.Vertices(), model.Faces()))
            {
                string result = Result(surface, words[1], words[2], numbers);
                Console.WriteLine(string.Join(" ", words, 0, 7) + " " + result);
            }
        }
    }
}
