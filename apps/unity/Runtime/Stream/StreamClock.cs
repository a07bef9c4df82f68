using System;

namespace Shisei.Stream
{
    /// <summary>
    /// The hub's clock as the reader sees it: the shortest delay of late messages counts, since a network only ever
    /// adds to it. Follows clocks that run a little differently; begins anew after a jump.
    /// </summary>
    public sealed class StreamClock
    {
        /// <summary>Clocks drift apart by less than this, s a second.</summary>
        private const double Drift = 0.002;

        /// <summary>A message that is off by more than this comes from another start of the hub, s.</summary>
        private const double JumpSeconds = 2;

        private double offset;
        private double last;
        private bool known;

        public bool Known { get { return known; } }

        public void Clear() { known = false; }

        /// <summary>A message of the hub's time came; true when its clock has jumped.</summary>
        public bool Take(double hubSeconds, double arrivedSeconds)
        {
            double now = arrivedSeconds - hubSeconds;
            bool jumped = known && Math.Abs(now - offset) > JumpSeconds;
            if (!known || jumped) offset = now;
            else offset = Math.Min(now, offset + Drift * Math.Max(0, arrivedSeconds - last));
            last = arrivedSeconds;
            known = true;
            return jumped;
        }

        /// <summary>The hub's time at a moment of the reader's clock.</summary>
        public double HubSeconds(double nowSeconds) { return nowSeconds - offset; }
    }
}
