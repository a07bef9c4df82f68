namespace Shisei.Stream
{
    /// <summary>Where a pose comes from; the numbers of the stream.</summary>
    public enum Source
    {
        /// <summary>Vanished: the pose is the last one and not to be trusted.</summary>
        None = 0,
        /// <summary>Seen by the cameras.</summary>
        Optical = 1,
        /// <summary>Lost by the cameras and carried by the sensor.</summary>
        Bridged = 2,
        /// <summary>The sensor alone: attitude, no position.</summary>
        Inertial = 3,
    }

    public enum BodyKind
    {
        Body,
        Bone,
        Node,
    }

    /// <summary>What the stream says of a body.</summary>
    public sealed class BodyInfo
    {
        public int Id;
        public string Name;
        public BodyKind Kind;
        /// <summary>The skeleton of a bone, else null.</summary>
        public string Skeleton;
        /// <summary>Id of the bone it hangs on; −1 for none.</summary>
        public int Parent = -1;
        /// <summary>The sensor on it, or null.</summary>
        public string Node;
        /// <summary>In the body's own frame of shisei, m.</summary>
        public Vec3[] Markers = new Vec3[0];
    }

    /// <summary>One pose, in shisei's space.</summary>
    public struct BodyPose
    {
        /// <summary>On the hub's clock.</summary>
        public double TimeSeconds;
        public bool HasPosition;
        public Vec3 Position;
        public Quat WorldFromBody;
        public Source Source;
        /// <summary>How long the cameras have not seen it.</summary>
        public double GapSeconds;
        /// <summary>Expected errors, one standard deviation; NaN where unknown.</summary>
        public double SigmaDegrees;
        public double SigmaMillimetres;
    }
}
