using Shisei.Stream;

/// <summary>Handedness and interpolation against NumPy and SciPy.</summary>
internal static class SpaceTests
{
    public static void All()
    {
        double[,] f = Numbers.Frames;
        for (int k = 0; k < f.GetLength(0); k++)
        {
            Vec3 place = Axes.ToUnity(new Vec3(f[k, 4], f[k, 5], f[k, 6]));
            Checks.That("place " + k, place.X == f[k, 11] && place.Y == f[k, 12] && place.Z == f[k, 13]);
            Quat turned = Axes.ToUnity(new Quat(f[k, 0], f[k, 1], f[k, 2], f[k, 3]));
            double apart = Checks.Apart(turned, new Quat(f[k, 7], f[k, 8], f[k, 9], f[k, 10]));
            Checks.That("rotation " + k, apart < 1e-14, apart.ToString("R"));
        }
        // in words: up is up; what is north of the origin (y) is behind, at −z; x is mirrored
        Checks.That("up", Axes.ToUnity(new Vec3(0, 0, 1)).Y == 1);
        Checks.That("y goes to -z", Axes.ToUnity(new Vec3(0, 1, 0)).Z == -1);
        Checks.That("x goes to -x", Axes.ToUnity(new Vec3(1, 0, 0)).X == -1);

        double[,] s = Numbers.Slerps;
        for (int k = 0; k < s.GetLength(0); k++)
        {
            Quat a = new Quat(s[k, 0], s[k, 1], s[k, 2], s[k, 3]), b = new Quat(s[k, 4], s[k, 5], s[k, 6], s[k, 7]);
            Quat expected = new Quat(s[k, 9], s[k, 10], s[k, 11], s[k, 12]);
            double apart = Checks.Apart(Axes.Slerp(a, b, s[k, 8]), expected);
            Checks.That("slerp " + k, apart < 1e-13, apart.ToString("R"));
            // the same rotation with the other sign takes the same way
            apart = Checks.Apart(Axes.Slerp(a, new Quat(-b.W, -b.X, -b.Y, -b.Z), s[k, 8]), expected);
            Checks.That("slerp, other sign " + k, apart < 1e-13, apart.ToString("R"));
        }
        Quat unit;
        Checks.That("no rotation in zeros", !Axes.Normalise(new Quat(0, 0, 0, 0), out unit));
        Checks.That("no rotation in no numbers", !Axes.Normalise(new Quat(double.NaN, 0, 0, 1), out unit));
        Checks.That("equal ends", Checks.Apart(Axes.Slerp(Quat.Identity, Quat.Identity, 0.3), Quat.Identity) == 0);
    }
}
