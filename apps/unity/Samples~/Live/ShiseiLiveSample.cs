using System.Collections.Generic;
using Shisei.Stream;
using Shisei.Unity;
using UnityEngine;

/// <summary>Makes an object for every body of the stream, and says on the screen how the connection is.</summary>
public sealed class ShiseiLiveSample : MonoBehaviour
{
    [SerializeField] private ShiseiStream stream;

    private readonly Dictionary<string, GameObject> made = new Dictionary<string, GameObject>();
    private string note = "";

    private void OnEnable()
    {
        if (stream == null) stream = GetComponent<ShiseiStream>();
        stream.SceneChanged += Rebuild;
        stream.Note += Noted;
    }

    private void OnDisable()
    {
        stream.SceneChanged -= Rebuild;
        stream.Note -= Noted;
    }

    private void Noted(string english, string japanese)
    {
        note = Application.systemLanguage == SystemLanguage.Japanese ? japanese : english;
    }

    private void Rebuild()
    {
        HashSet<string> present = new HashSet<string>();
        foreach (BodyInfo body in stream.State.Bodies)
        {
            bool bone = body.Kind == BodyKind.Bone && body.Skeleton != null;
            string name = bone ? body.Skeleton + "/" + body.Name : body.Name;
            present.Add(name);
            if (!made.ContainsKey(name)) made[name] = Make(name, body);
        }
        foreach (string name in new List<string>(made.Keys))
        {
            if (present.Contains(name)) continue;
            Destroy(made[name]);
            made.Remove(name);
        }
    }

    private GameObject Make(string name, BodyInfo body)
    {
        GameObject thing = new GameObject(name);
        thing.transform.SetParent(transform, false);
        PrimitiveType form = body.Kind == BodyKind.Bone ? PrimitiveType.Sphere : PrimitiveType.Cube;
        float size = body.Kind == BodyKind.Body ? 0.06f : 0.04f;
        Part(thing, form, Vector3.zero, size);
        foreach (Vec3 marker in body.Markers)
        {
            Vec3 place = Axes.ToUnity(marker);
            Part(thing, PrimitiveType.Sphere, new Vector3((float)place.X, (float)place.Y, (float)place.Z), 0.016f);
        }
        thing.AddComponent<ShiseiBody>().Follow(stream, name, true);
        return thing;
    }

    private static void Part(GameObject of, PrimitiveType form, Vector3 place, float size)
    {
        GameObject part = GameObject.CreatePrimitive(form);
        Destroy(part.GetComponent<Collider>());
        part.transform.SetParent(of.transform, false);
        part.transform.localPosition = place;
        part.transform.localScale = new Vector3(size, size, size);
    }

    private void OnGUI()
    {
        string line = "shisei: " + stream.Link + "  " + stream.State.Bodies.Length + " bodies  " + stream.Problem;
        GUI.Label(new Rect(12, 8, 900, 24), line);
        GUI.Label(new Rect(12, 30, 900, 24), note);
    }
}
