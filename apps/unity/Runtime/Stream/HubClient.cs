using System;
using System.Diagnostics;
using System.Net.WebSockets;
using System.Text;
using System.Threading;
using System.Threading.Tasks;

namespace Shisei.Stream
{
    public enum Link
    {
        Stopped,
        Connecting,
        Connected,
        /// <summary>Waiting for the next try.</summary>
        Lost,
    }

    /// <summary>
    /// Keeps a connection to the hub's stream and fills a <see cref="StreamState"/>; comes back by itself. Its clock
    /// is <see cref="Now"/>.
    /// </summary>
    public sealed class HubClient : IDisposable
    {
        /// <summary>A message beyond this is passed over, bytes.</summary>
        public const int LargestMessage = 1 << 20;

        private const int FirstWaitMilliseconds = 250;
        private const int LongestWaitMilliseconds = 4000;
        private const int ConnectMilliseconds = 5000;
        /// <summary>A hub says something at least once a second.</summary>
        private const int SilenceMilliseconds = 10000;

        private static readonly Stopwatch Watch = Stopwatch.StartNew();

        private readonly Uri address;
        private readonly StreamState state;
        private readonly SemaphoreSlim sending = new SemaphoreSlim(1, 1);
        private readonly object gate = new object();
        private CancellationTokenSource stop;
        private ClientWebSocket socket;
        private Task running;
        private volatile Link link = Link.Stopped;
        private volatile string problem = "";

        /// <summary>`address` as the hub prints it: ws://HOST:PORT/stream, with ?token=… where one is needed.</summary>
        public HubClient(string address, StreamState state)
        {
            this.address = StreamAddress(address);
            this.state = state;
        }

        public Link Link { get { return link; } }

        /// <summary>Why the last connection ended, or "".</summary>
        public string Problem { get { return problem; } }

        /// <summary>Connections made so far.</summary>
        public int Connections { get; private set; }

        public static double Now { get { return Watch.Elapsed.TotalSeconds; } }

        /// <summary>The stream's address; that of the page in a browser will do as well.</summary>
        public static Uri StreamAddress(string address)
        {
            UriBuilder made = new UriBuilder(address.Contains("://") ? address : "ws://" + address);
            if (made.Scheme == "http") made.Scheme = "ws";
            if (made.Scheme == "https") made.Scheme = "wss";
            if (made.Scheme != "ws" && made.Scheme != "wss") throw new ArgumentException("not the address of a hub: " + address);
            if (made.Path == "" || made.Path == "/") made.Path = "/stream";
            return made.Uri;
        }

        public void Start()
        {
            lock (gate)
            {
                if (running != null) return;
                stop = new CancellationTokenSource();
                CancellationToken token = stop.Token;
                running = Task.Run(() => Run(token));
            }
        }

        public void Dispose()
        {
            Task ending;
            lock (gate)
            {
                if (running == null) return;
                stop.Cancel();
                ClientWebSocket open = socket;
                if (open != null) open.Abort();
                ending = running;
                running = null;
            }
            try
            {
                ending.Wait(1000);
            }
            catch (AggregateException)
            {
                // it ended with the cancelling, as asked
            }
            link = Link.Stopped;
        }

        /// <summary>Sends a request (see <see cref="Requests"/>); false when there is no connection.</summary>
        public bool Send(string request)
        {
            ClientWebSocket open;
            lock (gate) open = socket;
            if (open == null || link != Link.Connected) return false;
            SendOn(open, request).ContinueWith(Quietly, TaskContinuationOptions.OnlyOnFaulted);
            return true;
        }

        private static void Quietly(Task ended) { GC.KeepAlive(ended.Exception); }

        private async Task SendOn(ClientWebSocket open, string request)
        {
            await sending.WaitAsync().ConfigureAwait(false);
            try
            {
                byte[] bytes = Encoding.UTF8.GetBytes(request);
                await open.SendAsync(new ArraySegment<byte>(bytes), WebSocketMessageType.Text, true, CancellationToken.None).ConfigureAwait(false);
            }
            catch (Exception error)
            {
                // the reader notices the loss as well and connects anew
                problem = error.Message;
            }
            finally
            {
                sending.Release();
            }
        }

        private async Task Run(CancellationToken token)
        {
            int attempt = 0;
            while (!token.IsCancellationRequested)
            {
                link = Link.Connecting;
                ClientWebSocket made = new ClientWebSocket();
                try
                {
                    using (CancellationTokenSource patience = CancellationTokenSource.CreateLinkedTokenSource(token))
                    {
                        patience.CancelAfter(ConnectMilliseconds);
                        await made.ConnectAsync(address, patience.Token).ConfigureAwait(false);
                    }
                    lock (gate) socket = made;
                    link = Link.Connected;
                    Connections++;
                    long before = state.PosesMessages;
                    problem = await Receive(made, token).ConfigureAwait(false);
                    if (state.PosesMessages > before) attempt = 0;
                }
                catch (Exception error)
                {
                    problem = error.Message;
                }
                lock (gate) socket = null;
                made.Dispose();
                state.Lost();
                if (token.IsCancellationRequested) break;
                link = Link.Lost;
                int wait = Math.Min(LongestWaitMilliseconds, FirstWaitMilliseconds << Math.Min(attempt++, 5));
                try
                {
                    await Task.Delay(wait, token).ConfigureAwait(false);
                }
                catch (OperationCanceledException)
                {
                    break;
                }
            }
        }

        /// <summary>Reads until the connection ends; why it did.</summary>
        private async Task<string> Receive(ClientWebSocket open, CancellationToken token)
        {
            byte[] buffer = new byte[16384];
            int length = 0;
            bool tooLarge = false;
            while (!token.IsCancellationRequested)
            {
                WebSocketReceiveResult result;
                using (CancellationTokenSource patience = CancellationTokenSource.CreateLinkedTokenSource(token))
                {
                    patience.CancelAfter(SilenceMilliseconds);
                    result = await open.ReceiveAsync(new ArraySegment<byte>(buffer, length, buffer.Length - length), patience.Token).ConfigureAwait(false);
                }
                if (result.MessageType == WebSocketMessageType.Close) return "closed by the hub";
                length += result.Count;
                if (result.EndOfMessage)
                {
                    if (!tooLarge && result.MessageType == WebSocketMessageType.Text) state.Take(buffer, length, Now);
                    length = 0;
                    tooLarge = false;
                }
                else if (length == buffer.Length && buffer.Length < LargestMessage) Array.Resize(ref buffer, 2 * buffer.Length);
                else if (length == buffer.Length)
                {
                    tooLarge = true;
                    length = 0;
                }
            }
            return "";
        }
    }
}
