using System;
using System.Text;
using Shisei.Stream;

/// <summary>Counting, and messages to try.</summary>
internal static class Checks
{
    public static int Passed, Failed;

    public static void That(string name, bool ok, string detail = "")
    {
        if (ok) Passed++;
        else Failed++;
        if (!ok) Console.WriteLine("FAILED " + name + " " + detail);
    }

    public static void Near(string name, double got, double expected, double within)
    {
        That(name, Math.Abs(got - expected) <= within, got.ToString("R") + " instead of " + expected.ToString("R"));
    }

    /// <summary>The angle between two rotations, rad.</summary>
    public static double Apart(Quat a, Quat b)
    {
        double sign = a.W * b.W + a.X * b.X + a.Y * b.Y + a.Z * b.Z < 0 ? -1 : 1;
        double w = a.W - sign * b.W, x = a.X - sign * b.X, y = a.Y - sign * b.Y, z = a.Z - sign * b.Z;
        return 2 * Math.Sqrt(w * w + x * x + y * y + z * z);
    }

    public static bool Take(StreamState state, string message, double arrived = 0)
    {
        byte[] bytes = Encoding.UTF8.GetBytes(message);
        return state.Take(bytes, bytes.Length, arrived);
    }

    public static bool Soon(Func<bool> question, double seconds = 10)
    {
        double end = HubClient.Now + seconds;
        while (HubClient.Now < end)
        {
            if (question()) return true;
            System.Threading.Thread.Sleep(10);
        }
        return question();
    }

    public const string Scene =
        "{\"type\":\"scene\",\"bodies\":[{\"id\":1,\"name\":\"Tool 1\",\"kind\":\"body\",\"skeleton\":null,\"parent\":null,\"node\":\"N\",\"markers\":[[0.1,0,0],[0,0.2,0]]}," +
        "{\"id\":2,\"name\":\"Hips\",\"kind\":\"bone\",\"skeleton\":\"Alice\",\"parent\":null,\"node\":null,\"markers\":[]}," +
        "{\"id\":3,\"name\":\"\\u624b\\\"\\\\<b>\",\"kind\":\"node\",\"skeleton\":null,\"parent\":3,\"node\":\"W\",\"markers\":[]}]}";

    public static string Poses(double time, params string[] rows)
    {
        return "{\"poses\":[" + string.Join(",", rows) + "],\"markers\":[[1,2,3]],\"time_s\":" +
            time.ToString("R", System.Globalization.CultureInfo.InvariantCulture) + ",\"type\":\"poses\",\"frame\":null}";
    }
}
