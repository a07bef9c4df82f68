using System;
using Shisei.Stream;
using UnityEngine;
using UnityEngine.Events;

namespace Shisei.Unity
{
    /// <summary>What becomes of an object whose body has vanished.</summary>
    public enum WhenVanished
    {
        /// <summary>It stays where it was, in the colour of what has vanished.</summary>
        Stay,
        /// <summary>Its renderers are switched off.</summary>
        Hide,
    }

    /// <summary>Moves this object with a body of the stream.</summary>
    [AddComponentMenu("shisei/Body")]
    public sealed class ShiseiBody : MonoBehaviour
    {
        [Serializable]
        public sealed class SourceEvent : UnityEvent<int> { }

        [Tooltip("Where the stream comes from; empty: the first one in the scene.")]
        [SerializeField] private ShiseiStream stream;

        [Tooltip("\"Tool 1\", or \"Alice/LeftHand\" for a bone of a skeleton.")]
        [SerializeField] private string bodyName = "";

        [SerializeField] private bool applyPosition = true;
        [SerializeField] private bool applyRotation = true;

        [Tooltip("The pose is relative to the parent object: scale or move the whole laboratory with it.")]
        [SerializeField] private bool local = true;

        [SerializeField] private WhenVanished whenVanished = WhenVanished.Stay;

        [Tooltip("Tints the renderers by source: optical, bridged, inertial, vanished.")]
        [SerializeField] private bool tint;

        [SerializeField] private SourceEvent sourceChanged = new SourceEvent();

        private static readonly Color[] Colours =
        {
            new Color(0.49f, 0.53f, 0.59f), new Color(0.10f, 0.45f, 0.78f), new Color(0.90f, 0.53f, 0.05f), new Color(0.55f, 0.30f, 0.80f),
        };

        private MaterialPropertyBlock block;
        private Renderer[] renderers;
        private int scene = -1;
        private int id = -1;
        private int shown = -1;

        /// <summary>Optical, bridged, inertial, or None: vanished, or never seen.</summary>
        public Source Source { get; private set; }

        /// <summary>The newest pose in shisei's space, with gap and expected errors.</summary>
        public BodyPose Pose { get; private set; }

        /// <summary>Gets the number of a <see cref="Shisei.Stream.Source"/>.</summary>
        public SourceEvent SourceChanged { get { return sourceChanged; } }

        public string BodyName
        {
            get { return bodyName; }
            set
            {
                bodyName = value;
                scene = -1;
            }
        }

        /// <summary>For objects made by a script.</summary>
        public void Follow(ShiseiStream from, string name, bool tinted)
        {
            stream = from;
            tint = tinted;
            BodyName = name;
        }

        private void Start()
        {
#if UNITY_2023_1_OR_NEWER
            if (stream == null) stream = FindFirstObjectByType<ShiseiStream>();
#else
            if (stream == null) stream = FindObjectOfType<ShiseiStream>();
#endif
            renderers = GetComponentsInChildren<Renderer>();
            block = new MaterialPropertyBlock();
        }

        private void LateUpdate()
        {
            if (stream == null) return;
            if (scene != stream.State.SceneVersion)
            {
                scene = stream.State.SceneVersion;
                id = stream.IdOf(bodyName);
            }
            Vector3 position;
            Quaternion rotation;
            BodyPose pose;
            if (!stream.TryGetPose(id, out position, out rotation, out pose))
            {
                Show(Source.None);
                return;
            }
            Pose = pose;
            if (pose.Source != Source.None)
            {
                if (applyRotation && local) transform.localRotation = rotation;
                else if (applyRotation) transform.rotation = rotation;
                if (applyPosition && pose.HasPosition && local) transform.localPosition = position;
                else if (applyPosition && pose.HasPosition) transform.position = position;
            }
            Show(pose.Source);
        }

        private void Show(Source source)
        {
            Source = source;
            if (shown == (int)source || renderers == null) return;
            shown = (int)source;
            foreach (Renderer part in renderers)
            {
                if (part == null) continue;
                part.enabled = source != Source.None || whenVanished != WhenVanished.Hide;
                if (!tint) continue;
                part.GetPropertyBlock(block);
                block.SetColor("_Color", Colours[shown]);
                block.SetColor("_BaseColor", Colours[shown]);
                part.SetPropertyBlock(block);
            }
            sourceChanged.Invoke(shown);
        }
    }
}
