using System;
using System.Collections.Generic;
using Shisei.Stream;
using UnityEngine;

namespace Shisei.Unity
{
    /// <summary>
    /// Receives the stream of <c>shisei live</c>. Bodies find their pose here by name (<see cref="ShiseiBody"/>);
    /// connections that break come back by themselves.
    /// </summary>
    [AddComponentMenu("shisei/Stream")]
    [DefaultExecutionOrder(-100)]
    public sealed class ShiseiStream : MonoBehaviour
    {
        [Tooltip("As `shisei live` prints it, with ?token=… where there is one.")]
        [SerializeField] private string address = "ws://127.0.0.1:7399/stream";

        [Tooltip("Seconds that poses are shown late, so that there is one on either side to go between.")]
        [Range(0f, 0.5f)]
        [SerializeField] private float delaySeconds = 0.04f;

        private readonly StreamState state = new StreamState();
        private readonly Dictionary<string, int> byName = new Dictionary<string, int>();
        private HubClient client;
        private int scene = -1;
        private int notes;

        /// <summary>The list of bodies has changed.</summary>
        public event Action SceneChanged;

        /// <summary>The hub has said something, in English and in Japanese.</summary>
        public event Action<string, string> Note;

        public StreamState State { get { return state; } }

        public Link Link { get { return client == null ? Link.Stopped : client.Link; } }

        /// <summary>Why the last connection ended, or "".</summary>
        public string Problem { get { return client == null ? "" : client.Problem; } }

        public string Address
        {
            get { return address; }
            set
            {
                address = value;
                if (isActiveAndEnabled)
                {
                    OnDisable();
                    OnEnable();
                }
            }
        }

        /// <summary>Sends one of <see cref="Requests"/>; false when there is no connection.</summary>
        public bool Send(string request) { return client != null && client.Send(request); }

        /// <summary>Id of a body: "Tool 1", or "Alice/LeftHand" for a bone of a skeleton; −1 when there is none.</summary>
        public int IdOf(string name)
        {
            int id;
            return name != null && byName.TryGetValue(name, out id) ? id : -1;
        }

        /// <summary>
        /// The pose of a body now, in Unity's space: left-handed, y up, metres. False when there never was one; a
        /// source of None means that it has vanished and the pose is an old one.
        /// </summary>
        public bool TryGetPose(int id, out Vector3 position, out Quaternion rotation, out BodyPose pose)
        {
            position = Vector3.zero;
            rotation = Quaternion.identity;
            if (!state.Sample(id, HubClient.Now, out pose)) return false;
            Vec3 place = Axes.ToUnity(pose.Position);
            Quat turned = Axes.ToUnity(pose.WorldFromBody);
            position = new Vector3((float)place.X, (float)place.Y, (float)place.Z);
            rotation = new Quaternion((float)turned.X, (float)turned.Y, (float)turned.Z, (float)turned.W);
            return true;
        }

        private void OnEnable()
        {
            state.DelaySeconds = delaySeconds;
            try
            {
                client = new HubClient(address, state);
                client.Start();
            }
            catch (Exception error)
            {
                Debug.LogError("shisei: " + error.Message, this);
                client = null;
            }
        }

        private void OnDisable()
        {
            if (client != null) client.Dispose();
            client = null;
        }

        private void Update()
        {
            state.DelaySeconds = delaySeconds;
            if (scene != state.SceneVersion)
            {
                scene = state.SceneVersion;
                byName.Clear();
                foreach (BodyInfo body in state.Bodies)
                {
                    byName[body.Kind == BodyKind.Bone && body.Skeleton != null ? body.Skeleton + "/" + body.Name : body.Name] = body.Id;
                }
                if (SceneChanged != null) SceneChanged();
            }
            if (notes != state.Notes)
            {
                notes = state.Notes;
                if (Note != null) Note(state.NoteEnglish, state.NoteJapanese);
            }
        }
    }
}
