using System;
using System.Collections.Generic;

namespace Shisei.Stream
{
    /// <summary>
    /// What the stream has said so far. Messages come in on one thread (<see cref="Take"/>) and are read on another
    /// (<see cref="Sample"/>); a message that is none, or half of one, changes nothing but <see cref="BadMessages"/>.
    /// </summary>
    public sealed class StreamState
    {
        public const int Protocol = 1;
        public const int MostBodies = 1000;
        public const int MostMarkers = 4000;
        public const int LongestName = 120;
        /// <summary>A body that was not heard of for so long has vanished.</summary>
        public const double StaleSeconds = 1;

        private const int PoseColumns = 12;
        private const double FarthestMetres = 1e6;

        private readonly object gate = new object();
        private readonly JsonReader reader = new JsonReader();
        private readonly double[] row = new double[PoseColumns];
        private readonly List<Vec3> markers = new List<Vec3>();
        private readonly List<Vec3> newMarkers = new List<Vec3>();
        private readonly StreamClock clock = new StreamClock();
        private Dictionary<int, PoseTrack> tracks = new Dictionary<int, PoseTrack>();
        private BodyPose[] pending = new BodyPose[16];
        private int[] pendingIds = new int[16];
        private BodyInfo[] bodies = new BodyInfo[0];

        /// <summary>Seconds that poses are shown late, so that there is one on either side to go between.</summary>
        public double DelaySeconds = 0.04;

        /// <summary>Rises with every new list of bodies.</summary>
        public int SceneVersion { get; private set; }

        /// <summary>The hub's protocol; 0 before it said so.</summary>
        public int HubProtocol { get; private set; }

        public long PosesMessages { get; private set; }

        public long BadMessages { get; private set; }

        /// <summary>The newest note of the hub in English and Japanese, and how many there were.</summary>
        public string NoteEnglish { get; private set; }

        public string NoteJapanese { get; private set; }

        public int Notes { get; private set; }

        /// <summary>The bodies of the newest scene; a new array whenever it changes.</summary>
        public BodyInfo[] Bodies
        {
            get { lock (gate) return bodies; }
        }

        /// <summary>The single markers of the newest message, in shisei's space.</summary>
        public void CopyMarkers(List<Vec3> into)
        {
            lock (gate)
            {
                into.Clear();
                into.AddRange(markers);
            }
        }

        /// <summary>Takes a message's bytes (UTF-8); false when it was none.</summary>
        public bool Take(byte[] message, int length, double arrivedSeconds)
        {
            lock (gate)
            {
                try
                {
                    reader.Reset(message, length);
                    reader.BeginObject();
                    string type = null;
                    while (reader.NextKey())
                    {
                        if (type == null && reader.KeyIs("type")) type = reader.Text(16);
                        else reader.Skip();
                    }
                    reader.Finish();
                    reader.Reset(message, length);
                    reader.BeginObject();
                    if (type == "poses") TakePoses(arrivedSeconds);
                    else if (type == "scene") TakeScene();
                    else if (type == "hello") TakeHello();
                    else if (type == "note") TakeNote();
                    else if (type != "status") throw new JsonException("no message of the stream");
                    return true;
                }
                catch (JsonException)
                {
                    BadMessages++;
                    return false;
                }
            }
        }

        /// <summary>The connection is gone: the next one may be to another start of the hub.</summary>
        public void Lost()
        {
            lock (gate) clock.Clear();
        }

        /// <summary>
        /// The pose of a body at a moment of the reader's clock, in shisei's space. A body that was not heard of lately
        /// comes with <see cref="Source.None"/> and its last pose; false when there never was one.
        /// </summary>
        public bool Sample(int id, double nowSeconds, out BodyPose pose)
        {
            lock (gate)
            {
                pose = default(BodyPose);
                PoseTrack track;
                if (!tracks.TryGetValue(id, out track) || track.Count == 0) return false;
                double hubSeconds = clock.Known ? clock.HubSeconds(nowSeconds) - DelaySeconds : double.PositiveInfinity;
                if (!track.At(hubSeconds, out pose)) return false;
                double silence = nowSeconds - track.ArrivedSeconds;
                if (silence > StaleSeconds)
                {
                    pose.Source = Source.None;
                    pose.GapSeconds = Math.Max(pose.GapSeconds, silence);
                }
                return true;
            }
        }

        private void TakeHello()
        {
            while (reader.NextKey())
            {
                if (reader.KeyIs("protocol"))
                {
                    double protocol = reader.Number();
                    HubProtocol = protocol > 0 && protocol < 1e6 ? (int)protocol : 0;
                }
                else reader.Skip();
            }
        }

        private void TakeNote()
        {
            string english = null, japanese = null;
            while (reader.NextKey())
            {
                if (reader.KeyIs("en")) english = reader.Text(500);
                else if (reader.KeyIs("ja")) japanese = reader.Text(500);
                else reader.Skip();
            }
            NoteEnglish = english ?? japanese ?? "";
            NoteJapanese = japanese ?? english ?? "";
            Notes++;
        }

        private void TakeScene()
        {
            List<BodyInfo> found = new List<BodyInfo>();
            Dictionary<int, PoseTrack> kept = new Dictionary<int, PoseTrack>();
            while (reader.NextKey())
            {
                if (!reader.KeyIs("bodies") || !reader.Next('['))
                {
                    reader.Skip();
                    continue;
                }
                reader.BeginArray();
                while (reader.NextItem())
                {
                    if (found.Count == MostBodies || !reader.Next('{'))
                    {
                        reader.Skip();
                        continue;
                    }
                    BodyInfo body = TakeBody();
                    if (body == null || kept.ContainsKey(body.Id)) continue;
                    PoseTrack track;
                    kept[body.Id] = tracks.TryGetValue(body.Id, out track) ? track : new PoseTrack();
                    found.Add(body);
                }
            }
            bodies = found.ToArray();
            tracks = kept;
            SceneVersion++;
        }

        private BodyInfo TakeBody()
        {
            BodyInfo body = new BodyInfo();
            int id = -1;
            reader.BeginObject();
            while (reader.NextKey())
            {
                if (reader.KeyIs("id")) id = Id(reader.Number());
                else if (reader.KeyIs("name")) body.Name = reader.Text(LongestName);
                else if (reader.KeyIs("skeleton")) body.Skeleton = reader.Text(LongestName);
                else if (reader.KeyIs("node")) body.Node = reader.Text(LongestName);
                else if (reader.KeyIs("parent")) body.Parent = Id(reader.Number());
                else if (reader.KeyIs("markers")) body.Markers = TakePoints(new List<Vec3>(), 64).ToArray();
                else if (reader.KeyIs("kind"))
                {
                    string kind = reader.Text(16);
                    body.Kind = kind == "bone" ? BodyKind.Bone : kind == "node" ? BodyKind.Node : BodyKind.Body;
                }
                else reader.Skip();
            }
            if (id < 0) return null;
            body.Id = id;
            if (string.IsNullOrEmpty(body.Name)) body.Name = "#" + id;
            if (body.Parent == id) body.Parent = -1;
            return body;
        }

        /// <summary>Nothing is changed before the whole message is read.</summary>
        private void TakePoses(double arrivedSeconds)
        {
            double time = double.NaN;
            int count = 0;
            newMarkers.Clear();
            while (reader.NextKey())
            {
                if (reader.KeyIs("time_s")) time = reader.Number();
                else if (reader.KeyIs("poses") && reader.Next('[')) count = TakeRows();
                else if (reader.KeyIs("markers")) TakePoints(newMarkers, MostMarkers);
                else reader.Skip();
            }
            if (!Axes.IsFinite(time)) throw new JsonException("poses without their time");
            if (clock.Take(time, arrivedSeconds))
            {
                foreach (PoseTrack track in tracks.Values) track.Clear();
            }
            for (int k = 0; k < count; k++)
            {
                PoseTrack track;
                if (!tracks.TryGetValue(pendingIds[k], out track)) continue;
                pending[k].TimeSeconds = time;
                track.Add(pending[k], arrivedSeconds);
            }
            markers.Clear();
            markers.AddRange(newMarkers);
            PosesMessages++;
        }

        private int TakeRows()
        {
            int count = 0;
            reader.BeginArray();
            while (reader.NextItem())
            {
                if (!reader.Next('[') || count == MostBodies)
                {
                    reader.Skip();
                    continue;
                }
                int columns = 0;
                reader.BeginArray();
                while (reader.NextItem())
                {
                    if (columns < PoseColumns) row[columns++] = reader.Number();
                    else reader.Skip();
                }
                int id = columns == PoseColumns ? Id(row[0]) : -1;
                Quat turned;
                if (id < 0 || !Axes.Normalise(new Quat(row[4], row[5], row[6], row[7]), out turned)) continue;
                if (count == pending.Length)
                {
                    Array.Resize(ref pending, 2 * count);
                    Array.Resize(ref pendingIds, 2 * count);
                }
                pendingIds[count] = id;
                pending[count++] = PoseOf(turned);
            }
            return count;
        }

        private BodyPose PoseOf(Quat turned)
        {
            BodyPose pose = default(BodyPose);
            pose.Position = new Vec3(row[1], row[2], row[3]);
            pose.HasPosition = Near(pose.Position);
            if (!pose.HasPosition) pose.Position = default(Vec3);
            pose.WorldFromBody = turned;
            double source = row[8];
            pose.Source = source == 1 ? Source.Optical : source == 2 ? Source.Bridged : source == 3 ? Source.Inertial : Source.None;
            pose.GapSeconds = row[9] >= 0 ? row[9] : 0;
            pose.SigmaDegrees = row[10];
            pose.SigmaMillimetres = row[11];
            return pose;
        }

        private List<Vec3> TakePoints(List<Vec3> into, int most)
        {
            if (!reader.Next('['))
            {
                reader.Skip();
                return into;
            }
            reader.BeginArray();
            while (reader.NextItem())
            {
                if (!reader.Next('['))
                {
                    reader.Skip();
                    continue;
                }
                Vec3 point = new Vec3(double.NaN, double.NaN, double.NaN);
                int axis = 0;
                reader.BeginArray();
                while (reader.NextItem())
                {
                    double value = reader.Number();
                    if (axis == 0) point.X = value;
                    else if (axis == 1) point.Y = value;
                    else if (axis == 2) point.Z = value;
                    axis++;
                }
                if (axis == 3 && Near(point) && into.Count < most) into.Add(point);
            }
            return into;
        }

        private static bool Near(Vec3 place)
        {
            return place.IsFinite && Math.Abs(place.X) < FarthestMetres && Math.Abs(place.Y) < FarthestMetres && Math.Abs(place.Z) < FarthestMetres;
        }

        private static int Id(double number)
        {
            return number >= 0 && number <= int.MaxValue && number == Math.Floor(number) ? (int)number : -1;
        }
    }
}
