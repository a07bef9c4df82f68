using System;
using System.Collections.Generic;
using System.Text;
using Shisei.Stream;

/// <summary>Messages into poses: what is taken, what is joined, what is refused.</summary>
internal static class StateTests
{
    public static void All()
    {
        Scene();
        Between();
        Vanishing();
        Jumps();
        Hostile();
    }

    private static StreamState Ready()
    {
        StreamState state = new StreamState { DelaySeconds = 0 };
        Checks.That("scene taken", Checks.Take(state, Checks.Scene));
        return state;
    }

    private static void Scene()
    {
        StreamState state = Ready();
        BodyInfo[] bodies = state.Bodies;
        Checks.That("three bodies", bodies.Length == 3 && state.SceneVersion == 1);
        Checks.That("a body", bodies[0].Id == 1 && bodies[0].Name == "Tool 1" && bodies[0].Node == "N" && bodies[0].Parent == -1 && bodies[0].Markers.Length == 2 && bodies[0].Markers[1].Y == 0.2);
        Checks.That("a bone", bodies[1].Kind == BodyKind.Bone && bodies[1].Skeleton == "Alice");
        Checks.That("a node, no parent of itself", bodies[2].Kind == BodyKind.Node && bodies[2].Name == "手\"\\<b>" && bodies[2].Parent == -1);
        Checks.That("hello", Checks.Take(state, "{\"type\":\"hello\",\"protocol\":1,\"may\":[]}") && state.HubProtocol == 1);
        Checks.That("note", Checks.Take(state, "{\"type\":\"note\",\"level\":\"info\",\"en\":\"a\",\"ja\":\"あ\"}") && state.NoteJapanese == "あ" && state.Notes == 1);
        Checks.That("status is passed over", Checks.Take(state, "{\"type\":\"status\",\"inputs\":[{\"name\":\"x\"}]}") && state.BadMessages == 0);
        Checks.That("poses", Checks.Take(state, Checks.Poses(5, "[1,1,2,3,0.5,0.5,0.5,0.5,2,0.4,0.1,7]"), 100));
        BodyPose pose;
        Checks.That("a pose", state.Sample(1, 100, out pose) && pose.HasPosition && pose.Position.Z == 3 && pose.Source == Source.Bridged && pose.GapSeconds == 0.4 && pose.SigmaMillimetres == 7);
        Checks.That("none of a body that was not in it", !state.Sample(2, 100, out pose) && !state.Sample(99, 100, out pose));
        List<Vec3> markers = new List<Vec3>();
        state.CopyMarkers(markers);
        Checks.That("markers", markers.Count == 1 && markers[0].Y == 2);
        Checks.That("the order of keys does not matter", state.PosesMessages == 1);
        Checks.That("sensor alone: no place", Checks.Take(state, Checks.Poses(5.1, "[3,null,null,null,1,0,0,0,3,9,null,null]"), 100.1) && state.Sample(3, 100.1, out pose) && !pose.HasPosition && pose.Source == Source.Inertial && double.IsNaN(pose.SigmaDegrees));
    }

    private static void Between()
    {
        StreamState state = Ready();
        state.DelaySeconds = 0.02;
        // a quarter turn about z and 1 m in 0.1 s; the second message was 30 ms late on its way
        double c = Math.Sqrt(0.5);
        Checks.Take(state, Checks.Poses(10, "[1,0,0,0,1,0,0,0,1,0,0,0]"), 50);
        Checks.Take(state, Checks.Poses(10.1, "[1,1,0,0," + c.ToString("R") + ",0,0," + c.ToString("R") + ",1,0,0,0]"), 50.13);
        BodyPose pose;
        // 50.095 is 10.095 of the hub; 20 ms before that are three quarters of the way
        Checks.That("between", state.Sample(1, 50.095, out pose));
        // (the clock allows for a drift of 2 ms a second)
        Checks.Near("three quarters of the way", pose.Position.X, 0.75, 5e-3);
        Checks.Near("three quarters of the turn", 2 * Math.Atan2(pose.WorldFromBody.Z, pose.WorldFromBody.W), pose.Position.X * Math.PI / 2, 1e-9);
        state.Sample(1, 50.5, out pose);
        Checks.That("never beyond the newest", pose.Position.X == 1);
        state.Sample(1, 40, out pose);
        Checks.That("never before the oldest", pose.Position.X == 0);
        // a gap is not joined
        Checks.Take(state, Checks.Poses(12, "[1,5,0,0,1,0,0,0,1,0,0,0]"), 52);
        state.Sample(1, 51.5, out pose);
        Checks.That("gaps are not joined", pose.Position.X == 1);
        // what has vanished is not joined either
        Checks.Take(state, Checks.Poses(12.05, "[1,9,0,0,1,0,0,0,0,0,null,null]"), 52.05);
        state.Sample(1, 52.06, out pose);
        Checks.That("nothing between seen and vanished", pose.Position.X == 5 && pose.Source == Source.Optical);
        for (int k = 0; k < 1000; k++) Checks.Take(state, Checks.Poses(13 + k / 60.0, "[1," + k + ",0,0,1,0,0,0,1,0,0,0]"), 53 + k / 60.0);
        state.Sample(1, 53 + 990.5 / 60 + 0.02, out pose);
        Checks.Near("a long stream", pose.Position.X, 990.5, 0.2);
    }

    private static void Vanishing()
    {
        StreamState state = Ready();
        Checks.Take(state, Checks.Poses(1, "[1,1,2,3,1,0,0,0,1,0,0,0]", "[2,1,2,3,1,0,0,0,1,0,0,0]"), 10);
        Checks.Take(state, Checks.Poses(1.9, "[2,1,2,3,1,0,0,0,1,0,0,0]"), 10.9);
        BodyPose pose;
        state.Sample(1, 10.9, out pose);
        Checks.That("still there", pose.Source == Source.Optical);
        state.Sample(1, 11.2, out pose);
        Checks.That("what no message names has vanished", pose.Source == Source.None && pose.GapSeconds > 1.1 && pose.Position.X == 1);
        state.Sample(2, 11.2, out pose);
        Checks.That("the other has not", pose.Source == Source.Optical);
        state.Lost();
        state.Sample(2, 30, out pose);
        Checks.That("without a hub everything has", pose.Source == Source.None);
    }

    private static void Jumps()
    {
        StreamState state = Ready();
        Checks.Take(state, Checks.Poses(1000, "[1,1,0,0,1,0,0,0,1,0,0,0]"), 10);
        Checks.Take(state, Checks.Poses(0.5, "[1,2,0,0,1,0,0,0,1,0,0,0]"), 10.1);
        BodyPose pose;
        state.Sample(1, 10.1, out pose);
        Checks.That("a hub that started anew", pose.Position.X == 2);
        Checks.Take(state, Checks.Poses(0.6, "[1,3,0,0,1,0,0,0,1,0,0,0]"), 10.2);
        state.Sample(1, 10.15, out pose);
        Checks.Near("and its clock", pose.Position.X, 2.5, 1e-6);
        Checks.Take(state, Checks.Poses(0.6, "[1,4,0,0,1,0,0,0,1,0,0,0]"), 10.2);
        state.Sample(1, 10.3, out pose);
        Checks.That("the same time twice: the newer one", pose.Position.X == 4);
    }

    private static void Hostile()
    {
        StreamState state = Ready();
        Checks.Take(state, Checks.Poses(1, "[1,1,2,3,1,0,0,0,1,0,0,0]"), 10);
        string[] bad =
        {
            "", "{", "[]", "null", "7", "{}", "{\"type\":\"other\"}", "{\"type\":5}", "{\"type\":\"poses\"}", "{\"type\":\"poses\",\"time_s\":\"now\",\"poses\":[]}", "{\"type\":\"poses\",\"time_s\":1e999,\"poses\":[]}",
            "{\"type\":\"poses\",\"time_s\":2,\"poses\":[[1,9,9,9,1,0,0,0,1,0,0,0]", "{\"type\":\"scene\",\"bodies\":[{\"id\":7}]", new string('[', 1000000), "\u0000\u0001",
        };
        foreach (string message in bad) Checks.That("refused: " + (message.Length > 40 ? "…" : message), !Checks.Take(state, message, 10));
        BodyPose pose;
        Checks.That("half a message changes nothing", state.Sample(1, 10, out pose) && pose.Position.X == 1 && state.Bodies.Length == 3 && state.BadMessages == bad.Length);
        string[] rows = { "null", "5", "\"x\"", "{}", "[]", "[1]", "[99,1,2,3,1,0,0,0,1,0,0,0]", "[-1,1,2,3,1,0,0,0,1,0,0,0]", "[1.5,1,2,3,1,0,0,0,1,0,0,0]", "[1,1,2,3,0,0,0,0,1,0,0,0]", "[1,1,2,3,9e99,0,0,0,1,0,0,0]", "[\"1\",1,2,3,1,0,0,0,1,0,0,0]" };
        Checks.That("rows that are none", Checks.Take(state, Checks.Poses(1.1, rows), 10.1) && state.Sample(1, 10.1, out pose) && pose.Position.X == 1);
        Checks.That("a place that is none", Checks.Take(state, Checks.Poses(1.2, "[1,1e300,2,3,1,0,0,0,77,-5,0,0,1,2,3]"), 10.2) && state.Sample(1, 10.3, out pose) && !pose.HasPosition && pose.Source == Source.None && pose.GapSeconds == 0);
        StringBuilder many = new StringBuilder("{\"type\":\"scene\",\"bodies\":[");
        for (int k = 0; k < 5000; k++) many.Append(k == 0 ? "" : ",").Append("{\"id\":" + k + ",\"name\":\"" + new string('n', 300) + "\"}");
        Checks.That("sizes are bounded", Checks.Take(state, many.Append("]}").ToString()) && state.Bodies.Length == StreamState.MostBodies && state.Bodies[0].Name.Length == StreamState.LongestName);
        // every beginning of a message, and every single byte of it changed
        byte[] good = Encoding.UTF8.GetBytes(Checks.Scene);
        StreamState other = new StreamState();
        for (int length = 0; length < good.Length; length++)
        {
            if (other.Take(good, length, 0)) Checks.That("half a scene", false, length.ToString());
        }
        Random random = new Random(5);
        for (int k = 0; k < 20000; k++)
        {
            byte[] changed = (byte[])good.Clone();
            changed[random.Next(changed.Length)] = (byte)random.Next(256);
            other.Take(changed, changed.Length, 0);
        }
        Checks.That("changed bytes do no harm", Checks.Take(other, Checks.Scene) && other.Bodies.Length == 3);
    }
}
