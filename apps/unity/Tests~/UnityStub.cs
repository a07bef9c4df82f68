// Just enough of UnityEngine that mcs can hold our components to its types, and a test can let them run. It does
// nothing that Unity does but keep values.
using System;
using System.Collections.Generic;

namespace UnityEngine
{
    public class Object
    {
        public static void Destroy(Object thing) { }
        public static T FindObjectOfType<T>() where T : class { return null; }
    }

    public class Component : Object
    {
        public GameObject gameObject;
        public Transform transform { get { return gameObject.transform; } }
        public T GetComponent<T>() where T : Component, new() { return gameObject.GetComponent<T>(); }
        public T[] GetComponentsInChildren<T>() where T : Component { return gameObject.All<T>(); }
    }

    public class Behaviour : Component { public bool isActiveAndEnabled = true; }

    public class MonoBehaviour : Behaviour { }

    public class Transform : Component
    {
        public Vector3 localPosition, position, localScale;
        public Quaternion localRotation = Quaternion.identity, rotation = Quaternion.identity;
        public void SetParent(Transform parent, bool worldPositionStays) { }
    }

    public class Renderer : Component
    {
        public bool enabled = true;
        public MaterialPropertyBlock Block;
        public void GetPropertyBlock(MaterialPropertyBlock block) { }
        public void SetPropertyBlock(MaterialPropertyBlock block) { Block = block; }
    }

    public class Collider : Component { }

    public sealed class MaterialPropertyBlock
    {
        public readonly Dictionary<string, Color> Colours = new Dictionary<string, Color>();
        public void SetColor(string name, Color colour) { Colours[name] = colour; }
    }

    public class GameObject : Object
    {
        private readonly List<Component> components = new List<Component>();
        public readonly string Name;
        public readonly Transform transform;

        public GameObject(string name)
        {
            Name = name;
            transform = new Transform();
            transform.gameObject = this;
        }

        public T AddComponent<T>() where T : Component, new()
        {
            T made = new T();
            made.gameObject = this;
            components.Add(made);
            return made;
        }

        public T GetComponent<T>() where T : Component, new()
        {
            foreach (Component one in components) if (one is T) return (T)one;
            return null;
        }

        public T[] All<T>() where T : Component
        {
            List<T> found = new List<T>();
            foreach (Component one in components) if (one is T) found.Add((T)one);
            return found.ToArray();
        }

        public static GameObject CreatePrimitive(PrimitiveType form) { return new GameObject(form.ToString()); }
    }

    public enum PrimitiveType { Sphere, Cube }

    public enum SystemLanguage { English, Japanese }

    public static class Application { public static SystemLanguage systemLanguage = SystemLanguage.English; }

    public static class GUI { public static void Label(Rect place, string text) { } }

    public static class Debug { public static void LogError(string message, Object context) { Console.Error.WriteLine(message); } }

    public struct Rect { public Rect(float x, float y, float width, float height) { } }

    public struct Color
    {
        public float r, g, b;
        public Color(float r, float g, float b) { this.r = r; this.g = g; this.b = b; }
    }

    public struct Vector3
    {
        public float x, y, z;
        public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
        public static Vector3 zero { get { return new Vector3(0, 0, 0); } }
    }

    public struct Quaternion
    {
        public float x, y, z, w;
        public Quaternion(float x, float y, float z, float w) { this.x = x; this.y = y; this.z = z; this.w = w; }
        public static Quaternion identity { get { return new Quaternion(0, 0, 0, 1); } }
    }

    // as in Unity, where it collides with other names of the same kind unless they are written in full
    public struct Pose { }

    public sealed class AddComponentMenu : Attribute { public AddComponentMenu(string name) { } }
    public sealed class DefaultExecutionOrder : Attribute { public DefaultExecutionOrder(int order) { } }
    public sealed class TooltipAttribute : Attribute { public TooltipAttribute(string text) { } }
    public sealed class RangeAttribute : Attribute { public RangeAttribute(float low, float high) { } }
    public sealed class SerializeField : Attribute { }
}

namespace UnityEngine
{
    // Unity has a type of this name in its engine; ours must not be hidden by it
    public enum Space { World, Self }
}

namespace UnityEngine.Events
{
    public class UnityEvent<T>
    {
        private event Action<T> heard;
        public void AddListener(Action<T> listener) { heard += listener; }
        public void Invoke(T value) { if (heard != null) heard(value); }
    }
}
