namespace Shisei.Stream
{
    /// <summary>The last poses of one body, and the pose between two of them.</summary>
    public sealed class PoseTrack
    {
        /// <summary>One second at 60 poses a second.</summary>
        public const int Kept = 64;

        /// <summary>Poses farther apart than this are not joined, s.</summary>
        public const double LongestStepSeconds = 0.25;

        private readonly BodyPose[] ring = new BodyPose[Kept];
        private int next;

        public int Count { get; private set; }

        /// <summary>When the newest came, on the reader's own clock.</summary>
        public double ArrivedSeconds { get; private set; }

        public void Clear()
        {
            Count = 0;
            next = 0;
        }

        /// <summary>Takes a newer pose; one that is older than the newest begins the track anew.</summary>
        public void Add(BodyPose pose, double arrivedSeconds)
        {
            ArrivedSeconds = arrivedSeconds;
            if (Count > 0 && pose.TimeSeconds == Back(0).TimeSeconds)
            {
                ring[Slot(0)] = pose;
                return;
            }
            if (Count > 0 && pose.TimeSeconds < Back(0).TimeSeconds) Clear();
            ring[next] = pose;
            next = (next + 1) % Kept;
            if (Count < Kept) Count++;
        }

        /// <summary>The pose at a time of the hub's clock; never one that is newer than all that came.</summary>
        public bool At(double timeSeconds, out BodyPose pose)
        {
            pose = default(BodyPose);
            if (Count == 0) return false;
            BodyPose after = Back(0);
            pose = after;
            if (timeSeconds >= after.TimeSeconds) return true;
            for (int back = 1; back < Count; back++)
            {
                BodyPose before = Back(back);
                if (before.TimeSeconds <= timeSeconds)
                {
                    pose = Between(before, after, timeSeconds);
                    return true;
                }
                after = before;
            }
            pose = after;
            return true;
        }

        private static BodyPose Between(BodyPose before, BodyPose after, double timeSeconds)
        {
            double step = after.TimeSeconds - before.TimeSeconds;
            bool joined = before.Source != Source.None && after.Source != Source.None;
            if (!joined || !(step > 0) || step > LongestStepSeconds) return before;
            double part = (timeSeconds - before.TimeSeconds) / step;
            BodyPose pose = before;
            pose.TimeSeconds = timeSeconds;
            pose.WorldFromBody = Axes.Slerp(before.WorldFromBody, after.WorldFromBody, part);
            if (before.HasPosition && after.HasPosition)
            {
                pose.Position = Axes.Lerp(before.Position, after.Position, part);
            }
            return pose;
        }

        private BodyPose Back(int back) { return ring[Slot(back)]; }

        private int Slot(int back) { return (next - 1 - back + 2 * Kept) % Kept; }
    }
}
