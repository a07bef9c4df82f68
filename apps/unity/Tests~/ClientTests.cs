using System;
using Shisei.Stream;
using Shisei.Unity;
using UnityEngine;

/// <summary>The connection: addresses, requests, coming back; and the components on top of it.</summary>
internal static class ClientTests
{
    public static void All()
    {
        Checks.That("address of a page", HubClient.StreamAddress("http://127.0.0.1:8080/?token=ab").AbsoluteUri == "ws://127.0.0.1:8080/stream?token=ab");
        Checks.That("address without all", HubClient.StreamAddress("lab:9000").AbsoluteUri == "ws://lab:9000/stream");
        Checks.That("another path is kept", HubClient.StreamAddress("wss://lab/x/stream").AbsoluteUri == "wss://lab/x/stream");
        bool refused = false;
        try
        {
            HubClient.StreamAddress("ftp://lab/");
        }
        catch (ArgumentException)
        {
            refused = true;
        }
        Checks.That("no address of a hub", refused);
        Checks.That("requests", Requests.Record(true) == "{\"type\":\"record\",\"on\":true}" && Requests.Align(3) == "{\"type\":\"align\",\"body\":3}" && Requests.Heading(3, -12.5) == "{\"type\":\"heading\",\"body\":3,\"deg\":-12.5}" && Requests.Heading(3, double.NaN) == "{\"type\":\"heading\",\"body\":3,\"deg\":0}");
        Checks.That("names are quoted", Requests.Name("a", "\"\\\n手") == "{\"type\":\"name\",\"node\":\"a\",\"name\":\"\\\"\\\\\\u000a手\"}");
        ComesBack();
        Components();
    }

    private static void ComesBack()
    {
        TestHub hub = new TestHub();
        StreamState state = new StreamState();
        using (HubClient client = new HubClient("ws://127.0.0.1:" + hub.Port + "/stream?token=t%2B1", state))
        {
            Checks.That("nothing goes out before", !client.Send("x"));
            client.Start();
            client.Start();
            Checks.That("it connects", Checks.Soon(() => client.Link == Link.Connected && hub.Clients == 1));
            Checks.That("with its token", hub.Asked == "GET /stream?token=t%2B1 HTTP/1.1", hub.Asked);
            hub.Send(Checks.Scene);
            hub.SendInPieces(Checks.Poses(1, "[1,1,2,3,1,0,0,0,1,0,0,0]"), 7);
            Checks.That("messages come, whole or in pieces", Checks.Soon(() => state.PosesMessages == 1));
            Checks.That("requests go", client.Send(Requests.Record(true)) && Checks.Soon(() => hub.Heard.Length == 1 && hub.Heard[0].Contains("record")));
            hub.Send(new string('[', 3 << 20));
            hub.Send("{\"type\":");
            hub.Send(Checks.Poses(2, "[1,1,2,3,1,0,0,0,1,0,0,0]"));
            Checks.That("what is too large or broken is passed over", Checks.Soon(() => state.PosesMessages == 2) && client.Connections == 1);
            hub.DropAll();
            Checks.That("it comes back after a loss", Checks.Soon(() => client.Connections == 2 && hub.Clients == 1));
            hub.Raw(new byte[] { 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff });
            hub.DropAll();
            Checks.That("and after nonsense", Checks.Soon(() => client.Connections == 3 && hub.Clients == 1));
            int port = hub.Port;
            hub.Dispose();
            Checks.That("it says that the hub is gone", Checks.Soon(() => client.Link == Link.Lost && client.Problem != ""));
            hub = new TestHub(port);
            Checks.That("and finds the next one", Checks.Soon(() => client.Link == Link.Connected && hub.Clients == 1));
        }
        Checks.That("it ends", Checks.Soon(() => hub.Clients >= 0));
        hub.Dispose();
    }

    /// <summary>The components with a stand-in for the engine: the last step, to float and to transforms.</summary>
    private static void Components()
    {
        using (TestHub hub = new TestHub())
        {
            GameObject root = new GameObject("stream");
            ShiseiStream stream = root.AddComponent<ShiseiStream>();
            Call(stream, "OnEnable");
            stream.Address = "ws://127.0.0.1:" + hub.Port + "/stream";
            int scenes = 0;
            stream.SceneChanged += () => scenes++;
            GameObject thing = new GameObject("tool");
            Renderer renderer = thing.AddComponent<Renderer>();
            ShiseiBody body = thing.AddComponent<ShiseiBody>();
            body.Follow(stream, "Tool 1", true);
            Call(body, "Start");
            Checks.That("the component connects", Checks.Soon(() => hub.Clients == 1));
            hub.Send(Checks.Scene);
            hub.Send(Checks.Poses(1, "[1,1,2,3,0.5,0.5,0.5,0.5,2,0,0,0]"));
            Checks.Soon(() => stream.State.PosesMessages == 1);
            Call(stream, "Update");
            Checks.That("a scene is told once", scenes == 1 && stream.IdOf("Tool 1") == 1 && stream.IdOf("Alice/Hips") == 2 && stream.IdOf("x") == -1);
            Call(body, "LateUpdate");
            Vector3 place = thing.transform.localPosition;
            Quaternion turned = thing.transform.localRotation;
            Checks.That("the object is moved, in Unity's space", place.x == -1 && place.y == 3 && place.z == -2);
            Checks.That("and turned", turned.w == 0.5f && turned.x == 0.5f && turned.y == -0.5f && turned.z == 0.5f);
            Checks.That("and tinted", body.Source == Source.Bridged && renderer.Block != null);
            int told = -1;
            body.SourceChanged.AddListener(source => told = source);
            Checks.That("what is not heard of vanishes, and stays where it was", Checks.Soon(() =>
            {
                Call(body, "LateUpdate");
                return told == 0 && body.Source == Source.None;
            }, 4) && thing.transform.localPosition.x == -1);
            Call(stream, "OnDisable");
            Checks.That("it stops", stream.Link == Link.Stopped);
        }
    }

    private static void Call(object on, string method)
    {
        on.GetType().GetMethod(method, System.Reflection.BindingFlags.Instance | System.Reflection.BindingFlags.NonPublic).Invoke(on, null);
    }
}
