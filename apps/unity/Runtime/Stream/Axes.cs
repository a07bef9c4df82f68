using System;

namespace Shisei.Stream
{
    /// <summary>A place or direction, m.</summary>
    public struct Vec3
    {
        public double X, Y, Z;

        public Vec3(double x, double y, double z)
        {
            X = x;
            Y = y;
            Z = z;
        }

        public bool IsFinite { get { return Axes.IsFinite(X) && Axes.IsFinite(Y) && Axes.IsFinite(Z); } }
    }

    /// <summary>A rotation as Hamilton's quaternion w, x, y, z: world_from_body, of length 1.</summary>
    public struct Quat
    {
        public double W, X, Y, Z;

        public Quat(double w, double x, double y, double z)
        {
            W = w;
            X = x;
            Y = y;
            Z = z;
        }

        public static Quat Identity { get { return new Quat(1, 0, 0, 0); } }
    }

    /// <summary>
    /// From shisei's space (right-handed, z up) to Unity's (left-handed, y up) and rotations between two.
    /// The change is shisei's `z-up` to `unity`: x, y, z of Unity are −x, z, −y of shisei, for the axes of the world and
    /// those of a body alike, as OptiTrack's own Unity plugin does with Motive's coordinates.
    /// </summary>
    public static class Axes
    {
        /// <summary>A place of shisei in Unity's coordinates.</summary>
        public static Vec3 ToUnity(Vec3 place)
        {
            return new Vec3(-place.X, place.Z, -place.Y);
        }

        /// <summary>A rotation of shisei in Unity's coordinates: the mirror turns its axis round.</summary>
        public static Quat ToUnity(Quat rotation)
        {
            return new Quat(rotation.W, rotation.X, -rotation.Z, rotation.Y);
        }

        /// <summary>The rotation of length 1; false when there is none (zeros, not numbers, far from length 1).</summary>
        public static bool Normalise(Quat q, out Quat unit)
        {
            double length = Math.Sqrt(q.W * q.W + q.X * q.X + q.Y * q.Y + q.Z * q.Z);
            if (!(length > 0.5 && length < 2))
            {
                unit = Quat.Identity;
                return false;
            }
            unit = new Quat(q.W / length, q.X / length, q.Y / length, q.Z / length);
            return true;
        }

        /// <summary>From a (part 0) to b (part 1) at constant rate, the short way round.</summary>
        public static Quat Slerp(Quat a, Quat b, double part)
        {
            double dot = a.W * b.W + a.X * b.X + a.Y * b.Y + a.Z * b.Z;
            double sign = dot < 0 ? -1 : 1;
            // the angle from lengths of difference and sum: good to the last digits for small ones too
            double dw = b.W - sign * a.W, dx = b.X - sign * a.X, dy = b.Y - sign * a.Y, dz = b.Z - sign * a.Z;
            double sw = b.W + sign * a.W, sx = b.X + sign * a.X, sy = b.Y + sign * a.Y, sz = b.Z + sign * a.Z;
            double angle = 2 * Math.Atan2(
                Math.Sqrt(dw * dw + dx * dx + dy * dy + dz * dz),
                Math.Sqrt(sw * sw + sx * sx + sy * sy + sz * sz));
            double first = 1 - part, second = part;
            if (angle > 1e-8)
            {
                first = Math.Sin((1 - part) * angle) / Math.Sin(angle);
                second = Math.Sin(part * angle) / Math.Sin(angle);
            }
            second *= sign;
            Quat between = new Quat(
                first * a.W + second * b.W,
                first * a.X + second * b.X,
                first * a.Y + second * b.Y,
                first * a.Z + second * b.Z);
            Quat unit;
            return Normalise(between, out unit) ? unit : a;
        }

        public static Vec3 Lerp(Vec3 a, Vec3 b, double part)
        {
            return new Vec3(a.X + part * (b.X - a.X), a.Y + part * (b.Y - a.Y), a.Z + part * (b.Z - a.Z));
        }

        public static bool IsFinite(double value) { return !double.IsNaN(value) && !double.IsInfinity(value); }
    }
}
