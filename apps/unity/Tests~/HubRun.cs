using System;
using System.Collections.Generic;
using Shisei.Stream;

/// <summary>A few seconds with a hub that runs (`shisei live --demo`).</summary>
internal static class HubRun
{
    public static void All(string address)
    {
        StreamState state = new StreamState();
        using (HubClient client = new HubClient(address, state))
        {
            client.Start();
            Checks.That("it connects", Checks.Soon(() => client.Link == Link.Connected), client.Problem);
            Checks.That("the hub speaks our protocol", Checks.Soon(() => state.HubProtocol == StreamState.Protocol));
            Checks.That("bodies are named", Checks.Soon(() => state.Bodies.Length >= 3 && Array.Exists(state.Bodies, body => body.Kind == BodyKind.Bone)));
            Checks.That("poses come", Checks.Soon(() => state.PosesMessages > 60, 20));
            Dictionary<int, Vec3> first = new Dictionary<int, Vec3>();
            HashSet<Source> sources = new HashSet<Source>();
            int moved = 0;
            double worst = 0;
            Checks.Soon(() =>
            {
                moved = 0;
                foreach (BodyInfo body in state.Bodies)
                {
                    BodyPose pose;
                    if (!state.Sample(body.Id, HubClient.Now, out pose)) continue;
                    sources.Add(pose.Source);
                    Quat q = pose.WorldFromBody;
                    worst = Math.Max(worst, Math.Abs(q.W * q.W + q.X * q.X + q.Y * q.Y + q.Z * q.Z - 1));
                    if (!pose.HasPosition) continue;
                    Vec3 start;
                    if (!first.TryGetValue(body.Id, out start)) first[body.Id] = pose.Position;
                    else if (Math.Abs(start.X - pose.Position.X) + Math.Abs(start.Y - pose.Position.Y) + Math.Abs(start.Z - pose.Position.Z) > 0.02) moved++;
                }
                return moved >= 3 && sources.Contains(Source.Optical) && sources.Contains(Source.Bridged);
            }, 40);
            Checks.That("at least three bodies move", moved >= 3, moved.ToString());
            Checks.That("cameras see bodies and lose them", sources.Contains(Source.Optical) && sources.Contains(Source.Bridged));
            Checks.That("rotations have length 1", worst < 1e-12, worst.ToString("R"));
            Checks.That("every message was understood", state.BadMessages == 0, state.BadMessages.ToString());
            Checks.That("on one connection", client.Connections == 1);
        }
    }
}
